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

    Over another mode than those of the step that is ``left`` nothing is commanded: then somebody else flies. A vehicle
    that lifts off while it is asked to disarm is held as one in the air.
    """
    if not scene.airborne and not scene.vehicle.armed:
        return (unarm_step(),)
    modes = None if left is None or left.modes is None else left.modes | {kind.hold_mode}
    # A vehicle that was in this mode before it took off may have told so last: two heartbeats show that it is now.
    seen = scene.vehicle.beats + (1 if scene.vehicle.mode == kind.hold_mode else 0)

    def holds(now: Scene) -> bool:
        return not now.vehicle.armed or (now.vehicle.mode == kind.hold_mode and now.vehicle.beats > seen)

    hold = change_mode_step(Stage.HOLD, kind.hold, kind.hold_mode, kind.mode_name(kind.hold_mode), modes)
    hold = replace(hold, at_once=True, confirmed=holds)
    landing = landing_steps(kind.land, kind.land_mode, frozenset({kind.hold_mode}), scene.height_m)
    in_air = (hold, *(landing if lands else ()))
    if scene.airborne:
        return in_air
    disarm = disarm_step(None)
    return (replace(disarm, confirmed=lambda now: now.airborne or disarm.confirmed(now)), *in_air)


def _settled(kind: Autopilot, course: Course) -> tuple[Step, ...]:
    return flight_steps(frozenset({kind.offboard_mode}), course.lasts_s)


def _landed(kind: Autopilot, course: Course) -> tuple[Step, ...]:
    return landing_steps(kind.land, kind.land_mode, frozenset({kind.offboard_mode}), course.altitude_m)
