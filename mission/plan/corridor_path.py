"""From a run to a smooth curve in the corridor of the shortest path that does what the run does, with its proof."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Final

import numpy as np
import shapely

from mission.errors import UnprovedError
from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.logic.automata.conjunction import Conjunction
from mission.plan.beginning import Beginning
from mission.plan.begun import StayLeft
from mission.plan.corridor_flight import Flown, Line, planned_along, rests
from mission.plan.covering import CoveredVisit, Covering
from mission.plan.kept import Kept
from mission.plan.pace import law_onward, limits_in_motion
from mission.plan.progress import Grounds, Stage, Stages, StagesOfRuns
from mission.plan.visits import covered_visits, passage_at, visits
from mission.planning.run import Run
from mission.spec.model import MissionSpec, Point, Region
from mission.steering.certificate import Certificate
from mission.steering.corridor import Way
from mission.steering.joined import JoinedCurve, Piece
from mission.steering.known_laws import KnownLaw
from mission.steering.motion import Motion, Pace
from mission.steering.polyline import Polyline
from mission.steering.rounded import RoundedPolyline
from mission.steering.taut import Spaces, TautLine, taut_path
from mission.steering.timing import level_acceleration

_ROOM_OF_TUBE: Final = 0.01
_ROOM_OF_EXTENT: Final = 2e-4
"""How far the curve stays from where its tube would touch what it must not, as parts of the tube and the domain."""
_AT_START: Final = -1  # of a stage: where the flight begins, before all others
_MORE_ROOM: Final = (1.0, 8.0)  # times that room, until a proof is found


@dataclass(frozen=True, eq=False)
class CorridorPath:
    """A flight through a corridor.

    Attributes:
        planned: The taut path, with the lanes of regions that are covered.
        curve: The smooth path, flown through between its rests: the way to the lap, and the lap.
        certificate: The proof.
        lap: Which leg is the lap; None where there is none.
        stops: Pairs (curve parameter, seconds) at which the vehicle loiters.
        covers: The lanes.
        margin_m: Half width of the square that has room round every place of it.
        onward: The motion with which laps end that are flown through; None where the curve ends at
            rest.
        known: The law of its first piece, where the curve begins in motion and that is known.
    """

    planned: Polyline
    curve: JoinedCurve
    certificate: Certificate
    lap: int | None
    stops: tuple[tuple[float, float], ...]
    covers: tuple[CoveredVisit, ...]
    margin_m: float
    onward: Motion | None
    known: tuple[KnownLaw, ...] = ()


def pace_of(spec: MissionSpec) -> Pace:
    """What the vehicle of a mission can do, and may."""
    acceleration = level_acceleration(spec.limits.acceleration_m_s2, spec.limits.tilt_rad)
    return Pace(min(spec.flight.speed_m_s, spec.limits.speed_m_s), acceleration, spec.limits.jerk_m_s3)


@dataclass(frozen=True, eq=False)
class CorridorPlanner:
    """Plans flights through corridors for one mission.

    Attributes:
        spec: The mission.
        partition: Its triangles.
        labelling: Their labels.
        restricted: Shape (M,), the triangles that must not be touched.
        automaton: Of what the flight satisfies.
        covering: Covers the mission's regions; None where a visit is just that.
        kept: What is flown as it was in a plan before.

    What was found for one beginning is there for the next one.
    """

    spec: MissionSpec
    partition: Partition
    labelling: Labelling
    restricted: BoolArray
    automaton: Conjunction
    covering: Covering | None
    kept: Kept
    _known: dict[tuple[Run, Point, float], tuple[Grounds, Stages]] = field(default_factory=dict)
    _spaces: Spaces = field(default_factory=dict)

    @property
    def pace(self) -> Pace:
        """What the vehicle can do, and may."""
        return pace_of(self.spec)

    def path(self, run: Run, begins: Beginning, certify: Callable[[JoinedCurve], Certificate]) -> CorridorPath:
        """A smooth path that does what a run does, proved.

        Args:
            run: The run.
            begins: Where the path begins, and with which motion.
            certify: Proves a curve.

        Raises:
            NoStagesError: What the run spells depends on its triangles.
            NoWayError: No path is as far from what it must not touch as its tube is wide.
            NoPlanError: A region that is visited cannot be covered as the mission asks.
            UnprovedError: There is no proof.
        """
        room_m = max(_ROOM_OF_TUBE * self.spec.flight.tube_m, _ROOM_OF_EXTENT * self.partition.extent_m)
        failure: UnprovedError | None = None
        for more in _MORE_ROOM:
            try:
                return self._proved(run, begins, certify, self.spec.flight.tube_m + more * room_m)
            except UnprovedError as error:
                failure = failure or error
        raise failure or UnprovedError("nothing was tried", counterexample=(), where_s=None)

    def _proved(
        self, run: Run, begins: Beginning, certify: Callable[[JoinedCurve], Certificate], margin_m: float
    ) -> CorridorPath:
        grounds, stages = self._staged(run, begins.place_m, margin_m)
        free, onward = stages.stages[0].free, begins.onward(self.pace)
        halt, known = None, list[KnownLaw]()
        if begins.halts and onward is not None:
            halt, laws = begins.halt(onward, free, self.pace, partial(limits_in_motion, self.spec, begins=onward.law))
            known.extend(laws)
        lead_m = begins.lead_m(free, self.pace) if halt is None else halt.position([halt.duration_s])
        to_lap, lap = self._lines(
            run, stages, replace(begins, place_m=(float(lead_m[-1, 0]), float(lead_m[-1, 1]))), grounds, margin_m
        )
        begins.check_turn(_to_rest(lead_m[-1:], [*to_lap, *lap]), self.pace)
        if len(lead_m) > 1:
            to_lap.insert(0, Line(Way(lead_m, free, None)))
        before = [] if halt is None else [Line(Way(halt.position([0.0, halt.duration_s]), free, None))]

        def begun(piece: Piece) -> None:
            if onward is not None:
                known.append(law_onward(self.spec, piece, onward.law))

        motion = None if onward is None else onward.motion(self.pace)
        flown = Flown(self.pace, to_lap, lap, halt or motion, self.kept, begun=begun)
        if not flown.moves:
            raise UnprovedError("the flight may end where it begins", counterexample=(), where_s=None)
        curve = flown.curve
        certificate = certify(curve)
        if not certificate.holds:
            raise UnprovedError(
                f"the tube of {certificate.tube_m:g} m around the curve {certificate.reason}",
                counterexample=certificate.counterexample,
                where_s=certificate.where_s,
            )
        return CorridorPath(
            planned=planned_along([*before, *to_lap], lap, self.pace.speed_m_s),
            curve=curve,
            certificate=certificate,
            lap=len(curve.legs) - 1 if lap else None,
            stops=flown.stops,
            covers=tuple(self._visit(begins, lanes, start_s) for lanes, start_s in flown.lanes),
            margin_m=margin_m,
            onward=flown.onward,
            known=tuple(known),
        )

    def _staged(self, run: Run, place_m: Point, margin_m: float) -> tuple[Grounds, Stages]:
        """Where the vehicle may be in each stage of a run; raises NoStagesError as in ``path``."""
        key = run, place_m, margin_m
        if key not in self._known:
            grounds = Grounds(self.partition, self.labelling, self.restricted, margin_m, self.spec.flight.landing_m)
            self._known[key] = grounds, StagesOfRuns(grounds, self.automaton, self.spec.semantics).of(run, place_m)
        return self._known[key]

    def _visit(self, begins: Beginning, curve: RoundedPolyline, start_s: float) -> CoveredVisit:
        left = next((left for left in begins.lanes if left.curve is curve), None)
        if left is not None:
            return left.at(start_s)
        if self.covering is None:
            raise ValueError("nothing is covered here")
        return self.covering.visit(curve, start_s)

    def _lines(
        self, run: Run, stages: Stages, begins: Beginning, grounds: Grounds, margin_m: float
    ) -> tuple[list[Line], list[Line]]:
        """The taut lines to the lap, and those of the lap, which begins at a rest if it has one."""
        start_m = np.array(begins.place_m)
        stretches, done, renumbered = self._stretches(run, stages, begins, grounds)
        lap_from = None if stages.lap is None else renumbered[stages.lap]
        entries = [renumbered[entry] for entry in stages.entries]
        # A lap that begins where one rests needs no way to there that does a part of it as well.
        resting = [entry for entry in entries if rests(done[entry - 1 if entry != lap_from else -1])]
        if begins.completes and lap_from is not None:
            resting = [lap_from]
        found = taut_path(start_m, stretches, lap=lap_from, entries=resting or entries, spaces=self._spaces)
        lines = [
            _line(
                line, stretches[line.stage], held_s or self._held_there_s(stretches[line.stage], line, margin_m), lanes
            )
            for line in (found.lines if found.lap is not None else self._as_kept(found.lines, stretches, done))
            for held_s, lanes in (done[line.stage],)
        ]
        if found.lap is None:
            return lines, []
        to_lap, lap = lines[: found.lap], lines[found.lap :]
        if to_lap and not begins.completes:
            # It leads to where the lap begins; what is done there is done at the end of each lap.
            to_lap[-1] = Line(to_lap[-1].way)
        first = next((number for number, line in enumerate(lap) if line.rests), None)
        if first is None:
            return to_lap, lap
        if lap[-1].rests:
            if to_lap and not begins.completes:
                to_lap[-1] = Line(to_lap[-1].way, lap[-1].held_s)
            return to_lap, lap
        head, tail = lap[: first + 1], lap[first + 1 :]
        covering = head[-1].lanes
        if covering is not None:
            # The lap begins with its lanes, so that the way to it does not cover as well.
            head[-1] = Line(head[-1].way)
            tail.insert(0, Line(Way(head[-1].way.points_m[-1:], head[-1].way.free, None), lanes=covering))
        return [*to_lap, *head], [*tail, *head]

    def _as_kept(
        self,
        lines: Sequence[TautLine],
        stretches: Sequence[Stage],
        done: Sequence[tuple[float, RoundedPolyline | None]],
    ) -> Sequence[TautLine]:
        """Lines of a flight without laps that come to rest where a plan before did."""
        last = len(lines) - 1
        rested = [
            done[line.stage][1] is None
            and (number == last or (done[line.stage][0] > 0.0 and stretches[line.stage].restart_m is None))
            for number, line in enumerate(lines)
        ]
        return self.kept.moved(lines, stretches, rested)

    def _stretches(
        self, run: Run, stages: Stages, begins: Beginning, grounds: Grounds
    ) -> tuple[list[Stage], list[tuple[float, RoundedPolyline | None]], list[int]]:
        """The stages with what is flown for those that cover; what is done at their ends; the new number of each."""
        covers = self._covers(run, stages, begins)
        first = replace(stages.stages[0], index=_AT_START)
        stays = list(self._stays(run, first, begins, grounds))
        stretches: list[Stage] = [replace(first, target=target) for _, target in stays]
        done: list[tuple[float, RoundedPolyline | None]] = [(stay.seconds, None) for stay, _ in stays]
        renumbered: list[int] = []
        for number, stage in [(_AT_START, first), *enumerate(stages.stages)]:
            lanes = covers.get(number, [])
            if number != _AT_START:
                renumbered.append(len(stretches))
            for curve in lanes:
                begin, end = curve.corners_m[0], curve.corners_m[-1]
                stretches.append(replace(stage, target=shapely.Point(begin), restart_m=end))
                done.append((0.0, curve))
            if not lanes and number != _AT_START:
                stretches.append(stage)
                done.append((self._held_s(stage), None))
        return stretches, done, renumbered

    def _held_s(self, stage: Stage) -> float:
        """How long the vehicle loiters where a stage ends."""
        if stage.index < 1:
            return 0.0
        return max((region.loiter_s for region in self.spec.regions if region.name in stage.names), default=0.0)

    def _held_there_s(self, stage: Stage, line: TautLine, margin_m: float) -> float:
        """The same where several regions would do, of none of which the stage knows: by where the line ends."""
        if stage.index < 1 or stage.names or stage.restart_m is not None:
            return 0.0
        half = margin_m - _ROOM_OF_EXTENT * self.partition.extent_m  # a line ends on a rim
        square = shapely.box(*(line.points_m[-1] - half), *(line.points_m[-1] + half))
        return max(
            (
                region.loiter_s
                for region in self.spec.regions
                if region.loiter_s > 0.0
                and shapely.covers(union_of(self.partition, self.labelling.triangles_of(region.name)), square)
            ),
            default=0.0,
        )

    def _stays(
        self, run: Run, first: Stage, begins: Beginning, grounds: Grounds
    ) -> Iterator[tuple[StayLeft, shapely.Geometry]]:
        """The stays that are under way where the flight begins, and where the vehicle stands in them."""
        for stay in begins.stays:
            if stay.region in self.labelling.label(run.states[0]):
                inside = np.zeros(self.partition.size, dtype=np.bool_)
                inside[self.labelling.triangles_of(stay.region)] = True
                yield stay, shapely.intersection(first.free, grounds.inside(inside))

    def _covers(self, run: Run, stages: Stages, begins: Beginning) -> dict[int, list[RoundedPolyline]]:
        """The lanes of each stage with whose visit regions are covered.

        A visit under way goes on at once where the flight begins in its region; else when that is first visited.
        """
        if self.covering is None:
            return {}
        whole, semantics = self.automaton.whole, self.spec.semantics
        asked = covered_visits(self.spec, self.partition, self.labelling, whole, run)
        passed = _passed(stages, np.array(begins.place_m)) if asked else {}
        here, once = self.labelling.label(run.states[0]), len(run.states) - len(run.suffix) * run.recurrent
        found: dict[int, list[RoundedPolyline]] = {}
        left = {lanes.region: lanes.curve for lanes in reversed(begins.lanes)}
        for name in sorted(left.keys() & here):
            found.setdefault(_AT_START, []).append(left[name])
        for index, regions in asked.items():
            passage = passage_at(self.labelling, whole, run, semantics, index)
            centre = self.partition.corners_m[run.states[index]].mean(axis=0)
            place = (float(centre[0]), float(centre[1]))
            for region in regions:
                stage = self._stage_of(run, stages, index, region)
                if index < once and region.name in left:
                    curve = left.pop(region.name)
                    if stage != _AT_START:
                        found.setdefault(stage, []).append(curve)
                else:
                    found.setdefault(stage, []).append(self.covering.lanes(region, passage, place, passed[stage]))
        return found

    def _stage_of(self, run: Run, stages: Stages, index: int, region: Region) -> int:
        """The stage that ends with the visit of a region."""
        inside = [region.name in self.labelling.label(triangle) for triangle in run.states]
        first, last = next((a, b) for a, b in visits(inside) if a <= index <= b)
        ends = [number for number, stage in enumerate(stages.stages) if first <= stage.index <= last]
        if not ends and first == 0:
            return _AT_START
        if not ends:
            raise UnprovedError(f"the visit of {region.name} changes nothing", counterexample=(), where_s=None)
        return ends[0]


def _passed(stages: Stages, start_m: FloatArray) -> dict[int, tuple[Point, Point]]:
    """Of each stage, from where the vehicle comes to its end, and where it goes then, were nothing covered."""
    found = taut_path(start_m, stages.stages, lap=stages.lap, entries=stages.entries)
    after = [*found.lines[1:], found.lines[-1 if found.lap is None else found.lap]]
    (x, y), (u, v) = start_m.tolist(), found.lines[0].points_m[:2][-1].tolist()
    passed = {_AT_START: ((x, y), (u, v))}
    for line, onward in zip(found.lines, after, strict=True):
        ends = line.points_m[-2:][0], onward.points_m[:2][-1]
        (x, y), (u, v) = (end.tolist() for end in ends)
        passed[line.stage] = (x, y), (u, v)
    return passed


def _to_rest(from_m: FloatArray, lines: Sequence[Line]) -> FloatArray:
    """The corners of lines from a place, shape (1, 2), up to the first rest, shape (n, 2)."""
    last = next((number for number, line in enumerate(lines) if line.rests), len(lines))
    return np.concatenate((from_m, *(line.way.points_m for line in lines[: last + 1])))


def _line(line: TautLine, stage: Stage, held_s: float, lanes: RoundedPolyline | None) -> Line:
    target = stage.target if shapely.get_dimensions(stage.target) > 0 and held_s == 0.0 else None
    return Line(Way(line.points_m, line.free, target), held_s, lanes)
