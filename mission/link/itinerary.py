"""The steps of a whole flight, and of what is left of it once it goes over to another course."""

from dataclasses import replace

from mission.link.autopilot import Autopilot
from mission.link.course import Course
from mission.link.fence_guard import FenceGuard
from mission.link.steps import (
    Scene,
    Step,
    change_mode_step,
    disarm_step,
    fence_step,
    flight_steps,
    landing_steps,
    unarm_step,
)
from mission.monitor.stage import Stage


def whole_flight(kind: Autopilot, course: Course, fence: FenceGuard | None) -> tuple[Step, ...]:
    """From disarmed on the ground to disarmed on the ground; what guards the flight comes first."""
    guarded = () if fence is None else (fence_step(fence),)
    return (*guarded, *kind.departure(course.altitude_m), *_settled(kind, course), *_landed(kind, course))


def taken_over(kind: Autopilot, course: Course) -> tuple[Step, ...]:
    """From where whoever led the vehicle left it in the air to disarmed on the ground."""
    return (*kind.return_to_setpoints, *_settled(kind, course), *_landed(kind, course))


def onward(kind: Autopilot, course: Course) -> tuple[Step, ...]:
    """From where another course is taken over to disarmed on the ground."""
    return (*_settled(kind, course)[1:], *_landed(kind, course))


def way_out(kind: Autopilot, scene: Scene, left: Step | None, *, lands: bool) -> tuple[Step, ...]:
    """Out of a flight that is given up: hold in the air, and land there if wanted; on the ground, disarm.

    Over another mode than those of the step that is ``left`` nothing is commanded: then somebody else flies.
    """
    if not scene.airborne:
        return (disarm_step(None) if scene.vehicle.armed else unarm_step(),)
    modes = None if left is None or left.modes is None else left.modes | {kind.hold_mode}
    hold = change_mode_step(Stage.HOLD, kind.hold, kind.hold_mode, kind.mode_name(kind.hold_mode), modes)
    hold = replace(hold, at_once=True)
    landing = landing_steps(kind.land, kind.land_mode, frozenset({kind.hold_mode}), scene.height_m)
    return (hold, *(landing if lands else ()))


def _settled(kind: Autopilot, course: Course) -> tuple[Step, ...]:
    return flight_steps(frozenset({kind.offboard_mode}), course.lasts_s)


def _landed(kind: Autopilot, course: Course) -> tuple[Step, ...]:
    return landing_steps(kind.land, kind.land_mode, frozenset({kind.offboard_mode}), course.altitude_m)
