"""Plans whose path is that of the fields, and missions that ask for one."""

from mission.plan import FlightPlan
from mission.spec.model import MissionSpec, Smoothing
from mission.steering.path import SteeringPath


def fields_of(plan: FlightPlan) -> SteeringPath:
    """The path of the fields, which the plan must have."""
    assert isinstance(plan.path, SteeringPath)
    return plan.path


def series_of(spec: MissionSpec) -> Smoothing:
    """The Fourier series, which the mission must ask for."""
    assert isinstance(spec.smoothing, Smoothing)
    return spec.smoothing
