"""Changes of the mission in flight: read, held for where the old plan would do what they forbid, planned, answered."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final, Protocol, TypeAlias

import numpy as np
from shapely.geometry.base import BaseGeometry

from mission.errors import MissionError, SpecError
from mission.fly.amendments import GO_ON, Amendment, AmendmentAnswer
from mission.fly.cause import Cause
from mission.fly.prohibitions import Prohibitions
from mission.fly.replanner import Replanner
from mission.fly.replanning import Replanning
from mission.fly.watch import FlightWatch
from mission.geometry.arrays import FloatArray
from mission.geometry.sweep import SweptSquare
from mission.link.guidance import Guidance
from mission.link.session import Session
from mission.monitor.stage import Stage
from mission.spec.amendment import amended, amended_text, asking_for, asks_the_same
from mission.spec.areas import boundary_ground, region_ground
from mission.spec.loader import parse_mission
from mission.spec.model import UNTIL_STOPPED, BoundaryDomain, MissionSpec, Point, RegionKind

if TYPE_CHECKING:
    from concurrent.futures import Future

_STEP_S: Final = 0.1
_LONGEST_S: Final = 3600.0
_SOON_S: Final = 4.0
_TRIES: Final = 3
"""Where the old plan leads in the time of so many plans, and in which the vehicle stops, a new formula must be kept."""
_MOST_SAID: Final = 200

_BEFORE: Final = frozenset(
    {
        Stage.CONNECT,
        Stage.STREAMS,
        Stage.READY,
        Stage.STANDBY,
        Stage.MODE,
        Stage.CHECKS,
        Stage.ARM,
        Stage.TAKE_OFF,
        Stage.CLIMB,
        Stage.STREAM,
        Stage.OFFBOARD,
        Stage.SETTLE,
    }
)


class Amendments(Protocol):
    """Where changes come from."""

    def take(self) -> Amendment | None:
        """The next, if there is one."""
        ...

    def answer(self, amendment: Amendment, answer: AmendmentAnswer) -> None:
        """Say what came of one."""
        ...

    def keep(self, number: int, mission: MissionSpec) -> None:
        """Keep a mission that was amended, with the number of its plan."""
        ...


class Amending:
    """Takes changes while the trajectory is flown, one at a time."""

    def __init__(
        self,
        session: Session,
        watch: FlightWatch,
        replanning: Replanning,
        amendments: Amendments,
        mission: MissionSpec,
    ) -> None:
        """Take none yet; ``mission`` is what is asked for, whatever of it is done already."""
        self._reading: tuple[Amendment, Future[_Read]] | None = None
        self._session, self._watch, self._replanning, self._amendments = session, watch, replanning, amendments
        self._mission, self._laps_before = mission, 0
        # So all that is made once is there before the first change comes.
        replanning.replanner.beside(partial(_rehearse, mission))

    def turn(self, now_s: float) -> None:
        """Take the next change, once nothing else is planned; those that come before the flight wait for it."""
        if self._replanning.busy or self._session.stage in _BEFORE:
            return
        if self._reading is None:
            change = self._amendments.take()
            if change is None:
                return
            self._reading = (
                change,
                self._replanning.replanner.beside(
                    partial(_read, change, self._mission, self._watch.place_m, self._replanning.replanner)
                ),
            )
        change, read = self._reading
        if not read.done():
            return
        self._reading = None
        guidance, vehicle_s = self._session.guidance, self._session.contact.arrives_s(now_s)
        if not self._session.redirectable or not isinstance(guidance, Guidance) or vehicle_s is None:
            why = self._session.pilot.words or f"the vehicle is {self._session.stage}"
            self._refuse(change, f"the mission cannot be changed now: {why}")
        elif not self._watch.plan.run.recurrent and _counts(change):
            self._refuse(change, "no laps are flown: there are none, or they are over; what is left is flown once")
        elif change.lines == (GO_ON,):
            if why := self._replanning.go_on(guidance, vehicle_s):
                self._refuse(change, why)
            else:
                words = "the plan that was left is flown on"
                self._amendments.answer(change, AmendmentAnswer(accepted=True, words=words))
        else:
            self._begin(change, read, guidance, vehicle_s)

    def _begin(self, change: Amendment, read: "Future[_Read]", guidance: Guidance, vehicle_s: float) -> None:
        leg = self._watch.legs.now
        try:
            mission, forbids = read.result()
        except MissionError as error:
            if isinstance(error, SpecError) and all(fault.path.startswith("start") for fault in error.faults):
                self._replanning.hold(guidance, vehicle_s)
                self._refuse(change, f"{_words(error)}; the vehicle holds: change the mission again, or `{GO_ON}`")
            else:
                self._refuse(change, _words(error))
            return
        altitude_m = leg.plan.trajectory.altitude_m
        if mission.flight.altitude_m != altitude_m:
            self._refuse(change, f"a flight keeps its altitude, {altitude_m:g} m")
            return
        fresh = not asks_the_same(mission, self._mission)
        wanted = mission if fresh else _left_of(mission, leg.plan.spec, leg.laps_before - self._laps_before)
        flown, tube_m = leg.plan.spec, leg.plan.certificate.tube_m
        planned, shut = guidance.course.planned, [*_shut(flown, mission)]
        threats = [*_met(shut, flown, mission, _ahead(guidance, vehicle_s, _LONGEST_S), tube_m)] if planned else []
        within_s = _SOON_S + _TRIES * self._replanning.replanner.takes_s
        soon = forbids is not None and planned and not threats
        waits = bool(soon and forbids and forbids.met(_ahead(guidance, vehicle_s, within_s), tube_m))

        def spares(places_m: FloatArray) -> bool:
            met = any(_met(shut, flown, mission, places_m, tube_m))
            return not met and not (forbids and forbids.met(places_m, tube_m))

        def told(why: str) -> None:
            if not why:
                self._mission = mission
                if fresh:
                    self._laps_before = self._watch.legs.laps
                self._amendments.answer(change, AmendmentAnswer(accepted=True, words="another plan is flown"))
            elif threats:
                holds = f"the vehicle holds, as the old plan leads through {', '.join(threats)}: change it again, or"
                self._refuse(change, f"{why}; {holds} `{GO_ON}`")
            else:
                self._refuse(change, f"{why}; the old plan is flown on")

        said = f"amended: {' '.join('; '.join(change.lines).split()) or 'another mission file'}"[:_MOST_SAID]
        self._replanning.begin(
            Cause(
                said,
                holds=bool(threats),
                waits=waits,
                spares=spares,
                amended=wanted,
                fresh=fresh,
                told=told,
                keep=lambda number: self._amendments.keep(number, mission),
            )
        )

    def _refuse(self, change: Amendment, why: str) -> None:
        self._amendments.answer(change, AmendmentAnswer(accepted=False, words=why))


_Read: TypeAlias = tuple[MissionSpec, Prohibitions | None]


def _read(change: Amendment, mission: MissionSpec, place_m: Point, replanner: Replanner) -> _Read:
    """The mission as it is from now on, and what it forbids where it asks for something else.

    Whoever plans reads it at the same time.

    Raises:
        MissionError: It has faults.
    """
    if not change.lines:
        replanner.foresee(change.mission.encode(errors="replace"))
        wanted = parse_mission(change.mission.encode(errors="replace"))
    else:
        replanner.foresee(amended_text(mission, change.lines, place_m))
        wanted = amended(mission, change.lines, place_m)
    return wanted, None if asks_the_same(wanted, mission) else Prohibitions.of(wanted)


def _rehearse(mission: MissionSpec) -> None:
    """Read a mission as if it were changed; what is wrong with it shows when it is."""
    with suppress(MissionError):
        amended(mission, (), mission.start.position_m)
        Prohibitions.of(mission)


def _counts(change: Amendment) -> bool:
    """Whether a change is of the number of laps alone."""
    return bool(change.lines) and all(line.split()[:1] == ["laps"] for line in change.lines)


def _left_of(mission: MissionSpec, flown: MissionSpec, laps_before: int) -> MissionSpec:
    """A mission that asks for what is left, as the plan that is flown does."""
    laps = mission.flight.laps
    left = laps if laps == UNTIL_STOPPED else laps - laps_before
    return asking_for(replace(mission, flight=replace(mission.flight, laps=left)), flown)


def _shut(flown: MissionSpec, mission: MissionSpec) -> Iterator[tuple[str, BaseGeometry]]:
    """The regions that a mission restricts and the one that is flown does not, and their ground."""
    for region in mission.regions:
        if region.kind is RegionKind.RESTRICTED and region not in flown.regions:
            ground = region_ground(region, mission.domain)
            if ground is not None:
                yield region.name, ground.kept


def _met(
    shut: Sequence[tuple[str, BaseGeometry]],
    flown: MissionSpec,
    mission: MissionSpec,
    places_m: FloatArray,
    tube_m: float,
) -> Iterator[str]:
    """What a tube around a way, its places of shape (n, 2), meets and must no longer, in plain words."""
    swept = SweptSquare(places_m, tube_m)
    yield from (name for name, ground in shut if swept.meets(ground))
    domain = mission.domain
    if domain == flown.domain or not isinstance(domain, BoundaryDomain):
        return
    if not swept.stays_in(boundary_ground(domain).kept):
        yield "what is beyond the boundary"


def _ahead(guidance: Guidance, vehicle_s: float, within_s: float) -> FloatArray:
    """Where the plan that is flown leads within a time, shape (n, 2)."""
    course, (from_s, _) = guidance.course_at(vehicle_s), guidance.pace_at(vehicle_s)
    until_s = min(course.duration_s, from_s + within_s)
    times = np.linspace(from_s, until_s, 2 + int((until_s - from_s) / _STEP_S))
    return course.trajectory.state(times)[0]


def _words(error: MissionError) -> str:
    """An error for whoever handed something in, with what to do about it."""
    if not isinstance(error, SpecError):
        return str(error)
    return "; ".join(f"{each.message}{f' ({each.hint})' if each.hint else ''}" for each in error.faults)
