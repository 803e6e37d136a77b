"""The steps of a whole flight, and of what is left of it once it goes over to another course."""

from mission.link.autopilot import Autopilot
from mission.link.course import Course
from mission.link.fence_guard import FenceGuard
from mission.link.steps import Step, fence_step, flight_steps, landing_steps


def whole_flight(kind: Autopilot, course: Course, fence: FenceGuard | None) -> tuple[Step, ...]:
    """From disarmed on the ground to disarmed on the ground; what guards the flight comes first."""
    guarded = () if fence is None else (fence_step(fence),)
    return (*guarded, *kind.departure(course.altitude_m), *_settled(kind, course), *_landed(kind, course))


def onward(kind: Autopilot, course: Course) -> tuple[Step, ...]:
    """From where another course is taken over to disarmed on the ground."""
    return (*_settled(kind, course)[1:], *_landed(kind, course))


def _settled(kind: Autopilot, course: Course) -> tuple[Step, ...]:
    return flight_steps(frozenset({kind.offboard_mode}), course.lasts_s)


def _landed(kind: Autopilot, course: Course) -> tuple[Step, ...]:
    return landing_steps(kind.land, kind.land_mode, frozenset({kind.offboard_mode}), course.altitude_m)
