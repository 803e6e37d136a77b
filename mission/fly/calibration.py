"""How a vehicle follows: a figure of eight at the mission's speed, and what it says of the tube."""

import io
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from mission.clock import Clock
from mission.decimals import decimal
from mission.errors import LinkError, VehicleError
from mission.fly.interruption import StopRequest
from mission.fly.loop import fly
from mission.fly.options import FlightOptions
from mission.fly.result import Progress
from mission.geometry.arrays import FloatArray
from mission.link.drag import DragEstimate
from mission.link.transport import Transport
from mission.monitor.gaps import gaps_text
from mission.plan.figure_of_eight import figure_of_eight
from mission.report.reading import parse_record
from mission.report.record import FlightRecord
from mission.report.tracking import Tracking, tracking_of
from mission.spec.model import MissionSpec
from mission.spec.tube import Margins

_RESERVE: Final = 1.25
"""What is written is more than what was seen on one day."""

_STEP: Final = 0.05
_LITTLE_DRAG_PER_S: Final = 0.02


@dataclass(frozen=True)
class Spread:
    """How errors spread, on the worse axis: half are below, one in a hundred above, and the largest."""

    half: float
    most: float
    largest: float


@dataclass(frozen=True)
class Calibration:
    """What a figure of eight has shown of a vehicle, with the corrections of setpoints.

    Attributes:
        speed_m_s: The largest that was asked for.
        duration_s: How long it took.
        position_m: Error of the position.
        velocity_m_s: Error of the velocity.
        lag_s: How far behind the trajectory the vehicle was on the whole, as a time; negative ahead.
        drag_per_s: Level drag over mass, by its lean.
        wind_m_s: East and north; None where there is too little drag to tell.
        margins: What follows for the tube.
    """

    speed_m_s: float
    duration_s: float
    position_m: Spread
    velocity_m_s: Spread
    lag_s: float
    drag_per_s: float
    wind_m_s: tuple[float, float] | None
    margins: Margins

    def fragment(self, spec: MissionSpec) -> str:
        """Lines of a mission file that say what was measured."""
        margins = self.margins
        return (
            f"# Measured by a figure of eight at up to {self.speed_m_s:.2g} m/s: errors of at most "
            f"{self.position_m.largest:.2f} m and {self.velocity_m_s.largest:.2f} m/s per axis.\n"
            "# They hold the wind of that flight; what is stronger is a disturbance, which comes on top of them.\n"
            "flight:\n"
            f"  speed_m_s: {decimal(spec.flight.speed_m_s)}\n"
            "  disturbance_m_s2: 0\n"
            "  tube:\n"
            f"    estimator_m: {decimal(margins.estimator_m)}\n"
            f"    following_m: {decimal(margins.following_m)}\n"
            f"    correction_m: {decimal(margins.correction_m)}\n"
            f"    following_m_s: {decimal(margins.following_m_s)}\n"
        )


def calibrate(
    spec: MissionSpec,
    transport: Transport,
    clock: Clock,
    *,
    options: FlightOptions | None = None,
    on_progress: Callable[[Progress], None] | None = None,
    vehicle_failure: Callable[[], str] | None = None,
    stop_request: Callable[[], StopRequest | None] | None = None,
    on_warning: Callable[[str], None] | None = None,
) -> Calibration:
    """Fly a figure of eight and measure how it is followed; arguments as of ``fly``.

    Raises:
        NoPlanError: There is no room for it.
        LinkError: The vehicle could not be found, or was lost for a while.
        VehicleError: It refused or failed, or the flight was ended before the figure was complete.
    """
    sink = io.BytesIO()
    result = fly(
        figure_of_eight(spec),
        transport,
        clock,
        FlightRecord(sink, mission="calibration"),
        options=replace(options or FlightOptions(), record_all=True),
        on_progress=on_progress,
        vehicle_failure=vehicle_failure,
        stop_request=stop_request,
        on_warning=on_warning,
        planner=lambda start_m: figure_of_eight(spec, start_m),
    )
    if not result.achieved:
        raise VehicleError(f"nothing was measured: {result.reason}")
    if result.gaps:
        # The vehicle waits for setpoints meanwhile, and is as far off as that takes it.
        raise LinkError(f"nothing was measured: {gaps_text(result.gaps)}; see to the link, then measure again")
    return measured(tracking_of(parse_record(sink.getvalue())), spec.flight.margins)


def measured(tracking: Tracking, before: Margins) -> Calibration:
    """What a flight says; the estimator's bound and the reach of corrections are taken from ``before``.

    Raises:
        VehicleError: Nothing was reported on the trajectory.
    """
    if not len(tracking.t_s):
        raise VehicleError("nothing was measured: the vehicle reported no position on the figure")
    position, velocity = _spread(tracking.error_m), _spread(tracking.velocity_error_m_s)
    asked = tracking.asked_velocity_m_s
    drag = DragEstimate()
    for t_s, (east, north), attitude in zip(
        tracking.t_s.tolist(), tracking.velocity_m_s.tolist(), tracking.attitude_rad.tolist(), strict=True
    ):
        if all(map(math.isfinite, (east, north, *attitude))):
            drag.observe(t_s, (east, north, 0.0), (attitude[0], attitude[1], attitude[2]))
    (still_east, still_north, _), drag_per_s = drag.lean_m_s2
    told = drag_per_s > _LITTLE_DRAG_PER_S
    return Calibration(
        speed_m_s=float(np.hypot(*asked.T).max()),
        duration_s=float(tracking.t_s[-1] - tracking.t_s[0]),
        position_m=position,
        velocity_m_s=velocity,
        lag_s=-float((tracking.error_m * asked).sum() / max(float((asked**2).sum()), 1e-9)),
        drag_per_s=drag_per_s,
        wind_m_s=(-still_east / drag_per_s, -still_north / drag_per_s) if told else None,
        margins=Margins(
            estimator_m=before.estimator_m,
            following_m=_rounded_up(position.largest),
            correction_m=before.correction_m,
            following_m_s=_rounded_up(velocity.largest),
        ),
    )


def _spread(errors: FloatArray) -> Spread:
    sizes = np.abs(errors).max(axis=1)
    half, most = np.quantile(sizes, (0.5, 0.99)).tolist()
    return Spread(half, most, float(sizes.max()))


def _rounded_up(value: float) -> float:
    return round(math.ceil(value * _RESERVE / _STEP) * _STEP, 6)
