"""Plans whose path is that of the fields, and missions that ask for one."""

from dataclasses import replace

from mission.plan import FlightPlan
from mission.spec.model import Cost, Extension, MissionSpec, Smoothing
from mission.steering.path import SteeringPath


def fields_of(plan: FlightPlan) -> SteeringPath:
    """The path of the fields, which the plan must have."""
    assert isinstance(plan.path, SteeringPath)
    return plan.path


def series_of(spec: MissionSpec) -> Smoothing:
    """The Fourier series, which the mission must ask for."""
    assert isinstance(spec.smoothing, Smoothing)
    return spec.smoothing


BY_FIELDS = "smoothing: {frequencies: auto}\nsearch: {cost: transitions}\n"
"""As the paper flies: runs of fewest triangles, a field in each, and a Fourier series of the path."""


def by_fields(spec: MissionSpec) -> MissionSpec:
    """The mission, flown as the paper flies."""
    return replace(spec, smoothing=Smoothing(Extension.ODD, "auto"), search=replace(spec.search, cost=Cost.TRANSITIONS))
