"""How a new plan is come to: where it begins, and what is flown up to there.

From within the tube the plan that is flown is left at a time ahead: in flight where the new one can begin so, or slowed
to rest along itself, which stays within what was proved. From outside of it the vehicle comes to rest close to where it
is.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.link.course import Bounds, Course, Reference
from mission.link.guidance import Guidance
from mission.link.halting import slowed, stopping_place, transfer
from mission.spec.model import Point

_REST: Final = (0.0, 0.0, 0.0)
_SHARES: Final = tuple(k / 8 for k in range(1, 9))
"""Where it is looked through which triangles a stretch leads."""

_STEP_S: Final = 0.1
"""Likewise, where nothing may be missed."""


@dataclass(frozen=True, eq=False)
class Approach:
    """What is flown until a new plan begins.

    Attributes:
        course: That; None where it is the plan that is flown.
        from_s: Vehicle time at which it begins.
        until_s: Vehicle time at which it is over.
        begin: What the new plan begins with.
        flown_s: Time on the trajectory of the plan that is flown then; None where none is.
        through_m: Places through which it leads.
    """

    course: Course | None
    from_s: float
    until_s: float
    begin: Reference
    flown_s: float | None
    through_m: tuple[Point, ...]


def in_flight(guidance: Guidance, at_s: float, now_s: float) -> Approach:
    """Leave the plan that is flown at a vehicle time, without slowing down; up to then its pace stays as it is."""
    begin = guidance.promise(at_s)
    planned_s = guidance.course_at(at_s).planned_s(guidance.pace_at(at_s)[0])
    return Approach(None, at_s, at_s, begin, planned_s, _ahead(guidance, at_s, now_s))


def along(guidance: Guidance, at_s: float, now_s: float) -> Approach:
    """Slow the plan that is flown to rest along itself, from a vehicle time on; up to then its pace stays as it is."""
    guidance.promise(at_s)
    before, (from_s, rate) = guidance.course_at(at_s), guidance.pace_at(at_s)
    halt = slowed(before.trajectory, max(from_s, 0.0), rate, before.bounds.acceleration_m_s2)

    def planned_s(t_s: float) -> float | None:
        return before.planned_s(halt.planned_s(t_s))

    course = Course(halt, before.heading_rad, before.bounds, before.nose, planned_s=planned_s, waits=True)
    onward = [course.reference(share * halt.duration_s).position_m[:2] for share in _SHARES]
    through = (*_ahead(guidance, at_s, now_s), *onward)
    end, until_s = _at_rest(course), at_s + halt.duration_s
    return Approach(course, at_s, until_s, end, planned_s(halt.duration_s), through)


def aside(begin: Reference, bounds: Bounds, at_s: float, place_m: Point | None = None) -> Approach:
    """Come to rest from where the vehicle is, at a vehicle time: where it stops soonest, or at a place."""
    end_m = stopping_place(begin, bounds.acceleration_m_s2) if place_m is None else place_m
    way = transfer(begin, end_m, bounds.acceleration_m_s2)
    course = Course(way, 0.0, bounds, planned_s=lambda _: None, waits=True)
    end = _at_rest(course)
    return Approach(course, at_s, at_s + way.duration_s, end, None, (begin.position_m[:2], end_m))


def standing(course: Course, at_s: float, elapsed_s: float) -> Approach:
    """Wait where the vehicle waits already, or comes to rest; the course has lasted so long at a vehicle time."""
    end, left_s = _at_rest(course), max(course.duration_s - elapsed_s, 0.0)
    flown_s = course.planned_s(course.duration_s)
    return Approach(None, at_s, at_s + left_s, end, flown_s, (end.position_m[:2],))


def way_of(guidance: Guidance, approach: Approach, now_s: float) -> FloatArray:
    """The places, close together, on which the vehicle goes to where a new plan begins, shape (n, 2), from now on."""
    until_s = approach.until_s if approach.course is None else approach.from_s
    times = np.linspace(now_s, until_s, 2 + int((until_s - now_s) / _STEP_S))
    before = np.array([guidance.reference(t_s).position_m[:2] for t_s in times.tolist()])
    if approach.course is None:
        return before
    lasts_s = approach.course.duration_s
    times = np.linspace(0.0, lasts_s, 2 + int(lasts_s / _STEP_S))
    return np.concatenate((before, approach.course.trajectory.state(times)[0]))


def _at_rest(course: Course) -> Reference:
    """The end of a course, without what rounding leaves of its velocity."""
    return Reference(course.reference(course.duration_s).position_m, _REST, _REST)


def _ahead(guidance: Guidance, at_s: float, now_s: float) -> tuple[Point, ...]:
    return tuple(guidance.reference(now_s + share * (at_s - now_s)).position_m[:2] for share in _SHARES)
