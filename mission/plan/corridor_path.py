"""From a run to a smooth curve in the corridor of the shortest path that does what the run does, with its proof."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Final, NamedTuple

import numpy as np
import shapely

from mission.errors import UnprovedError
from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.logic.automata.conjunction import Conjunction
from mission.plan.beginning import Beginning
from mission.plan.covering import CoveredVisit, Covering
from mission.plan.progress import Grounds, Stage, Stages, StagesOfRuns
from mission.plan.visits import covered_visits, passage_at, visits
from mission.planning.run import Run
from mission.spec.model import MissionSpec, Point, Region
from mission.steering.bezier import DEGREE, BezierCurve
from mission.steering.certificate import Certificate
from mission.steering.corridor import Pace, Way, smooth_ways
from mission.steering.joined import Curve, JoinedCurve, Piece
from mission.steering.polyline import Polyline
from mission.steering.rounded import RoundedPolyline
from mission.steering.taut import TautLine, taut_path
from mission.steering.timing import level_acceleration

_ROOM_OF_TUBE: Final = 0.01
_ROOM_OF_EXTENT: Final = 2e-4
"""How far the curve stays from where its tube would touch what it must not, as parts of the tube and the domain."""
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
        onward: First and second derivative with which laps end that are flown through; None where the curve ends at
            rest.
    """

    planned: Polyline
    curve: JoinedCurve
    certificate: Certificate
    lap: int | None
    stops: tuple[tuple[float, float], ...]
    covers: tuple[CoveredVisit, ...]
    margin_m: float
    onward: tuple[FloatArray, FloatArray] | None


class _Line(NamedTuple):
    """A taut line with what is done at its end.

    Attributes:
        way: The line.
        held_s: How long the vehicle loiters at its end; 0 where it does not.
        lanes: The lanes that are flown then.
    """

    way: Way
    held_s: float = 0.0
    lanes: RoundedPolyline | None = None

    @property
    def rests(self) -> bool:
        return _rests((self.held_s, self.lanes))


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
    """

    spec: MissionSpec
    partition: Partition
    labelling: Labelling
    restricted: BoolArray
    automaton: Conjunction
    covering: Covering | None

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
        grounds = Grounds(self.partition, self.labelling, self.restricted, margin_m)
        stages = StagesOfRuns(grounds, self.automaton, self.spec.semantics).of(run, begins.place_m)
        free, onward = stages.stages[0].free, begins.onward(self.pace)
        halt = begins.halt(free, self.pace) if begins.halts else None
        lead_m = begins.lead_m(free, self.pace) if halt is None else halt.position([halt.duration_s])
        to_lap, lap = self._lines(run, stages, lead_m[-1], margin_m)
        if len(lead_m) > 1:
            to_lap.insert(0, _Line(Way(lead_m, free, None)))
        before = [] if halt is None else [_Line(Way(halt.position([0.0, halt.duration_s]), free, None))]
        flown = _Flown(self.pace, to_lap, lap, halt or (None if onward is None else onward[:2]))
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
            planned=_planned([*before, *to_lap], lap, self.pace.speed_m_s),
            curve=curve,
            certificate=certificate,
            lap=len(curve.legs) - 1 if lap else None,
            stops=flown.stops,
            covers=tuple(self.covering.visit(lanes, start_s) for lanes, start_s in flown.lanes)
            if self.covering
            else (),
            margin_m=margin_m,
            onward=flown.onward,
        )

    def _lines(self, run: Run, stages: Stages, start_m: FloatArray, margin_m: float) -> tuple[list[_Line], list[_Line]]:
        """The taut lines to the lap, and those of the lap, which begins at a rest if it has one."""
        covers = self._covers(run, stages, start_m)
        stretches: list[Stage] = []
        done: list[tuple[float, RoundedPolyline | None]] = []
        renumbered: list[int] = []
        for number, stage in enumerate(stages.stages):
            renumbered.append(len(stretches))
            lanes = covers.get(number, [])
            for curve in lanes:
                begin, end = curve.corners_m[0], curve.corners_m[-1]
                stretches.append(replace(stage, target=shapely.Point(begin), restart_m=end))
                done.append((0.0, curve))
            if not lanes:
                stretches.append(stage)
                done.append((self._held_s(stage), None))
        lap_from = None if stages.lap is None else renumbered[stages.lap]
        entries = [renumbered[entry] for entry in stages.entries]
        # A lap that begins where one rests needs no way to there that does a part of it as well.
        resting = [entry for entry in entries if _rests(done[entry - 1 if entry != lap_from else -1])]
        found = taut_path(start_m, stretches, lap=lap_from, entries=resting or entries)
        lines = [
            _line(
                line, stretches[line.stage], held_s or self._held_there_s(stretches[line.stage], line, margin_m), lanes
            )
            for line in found.lines
            for held_s, lanes in (done[line.stage],)
        ]
        if found.lap is None:
            return lines, []
        to_lap, lap = lines[: found.lap], lines[found.lap :]
        if to_lap:
            # It leads to where the lap begins; what is done there is done at the end of each lap.
            to_lap[-1] = _Line(to_lap[-1].way)
        first = next((number for number, line in enumerate(lap) if line.rests), None)
        if first is None:
            return to_lap, lap
        if lap[-1].rests:
            if to_lap:
                to_lap[-1] = _Line(to_lap[-1].way, lap[-1].held_s)
            return to_lap, lap
        head, tail = lap[: first + 1], lap[first + 1 :]
        covering = head[-1].lanes
        if covering is not None:
            # The lap begins with its lanes, so that the way to it does not cover as well.
            head[-1] = _Line(head[-1].way)
            tail.insert(0, _Line(Way(head[-1].way.points_m[-1:], head[-1].way.free, None), lanes=covering))
        return [*to_lap, *head], [*tail, *head]

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

    def _covers(self, run: Run, stages: Stages, start_m: FloatArray) -> dict[int, list[RoundedPolyline]]:
        """The lanes of each stage with whose visit regions are covered."""
        if self.covering is None:
            return {}
        whole, semantics = self.automaton.whole, self.spec.semantics
        asked = covered_visits(self.spec, self.partition, self.labelling, whole, run)
        passed = _passed(stages, start_m) if asked else {}
        found: dict[int, list[RoundedPolyline]] = {}
        for index, regions in asked.items():
            passage = passage_at(self.labelling, whole, run, semantics, index)
            centre = self.partition.corners_m[run.states[index]].mean(axis=0)
            place = (float(centre[0]), float(centre[1]))
            for region in regions:
                stage = self._stage_of(run, stages, index, region)
                found.setdefault(stage, []).append(self.covering.lanes(region, passage, place, passed[stage]))
        return found

    def _stage_of(self, run: Run, stages: Stages, index: int, region: Region) -> int:
        """The stage that ends with the visit of a region."""
        inside = [region.name in self.labelling.label(triangle) for triangle in run.states]
        first, last = next((a, b) for a, b in visits(inside) if a <= index <= b)
        ends = [number for number, stage in enumerate(stages.stages) if first <= stage.index <= last]
        if not ends:
            raise UnprovedError(f"the visit of {region.name} changes nothing", counterexample=(), where_s=None)
        return ends[0]


def _rests(done: tuple[float, RoundedPolyline | None]) -> bool:
    """Whether the vehicle rests where so long is loitered, or where lanes are flown."""
    held_s, lanes = done
    return held_s > 0.0 or lanes is not None


def _passed(stages: Stages, start_m: FloatArray) -> dict[int, tuple[Point, Point]]:
    """Of each stage, from where the vehicle comes to its end, and where it goes then, were nothing covered."""
    found = taut_path(start_m, stages.stages, lap=stages.lap, entries=stages.entries)
    after = [*found.lines[1:], found.lines[-1 if found.lap is None else found.lap]]
    passed = {}
    for line, onward in zip(found.lines, after, strict=True):
        ends = line.points_m[-2:][0], onward.points_m[:2][-1]
        (x, y), (u, v) = (end.tolist() for end in ends)
        passed[line.stage] = (x, y), (u, v)
    return passed


def _line(line: TautLine, stage: Stage, held_s: float, lanes: RoundedPolyline | None) -> _Line:
    target = stage.target if shapely.get_dimensions(stage.target) > 0 and held_s == 0.0 else None
    return _Line(Way(line.points_m, line.free, target), held_s, lanes)


class _Flown:
    """The curves along lines, what they are joined of, and what is done on them.

    Args:
        pace: What the vehicle can do.
        to_lap: The lines that are flown once.
        lap: Those of the lap; it begins at a rest, or has none.
        onward: What is flown before, or the first and second derivative with which the curve begins; None at rest.
    """

    def __init__(
        self,
        pace: Pace,
        to_lap: Sequence[_Line],
        lap: Sequence[_Line],
        onward: BezierCurve | tuple[FloatArray, FloatArray] | None,
    ) -> None:
        self._pace, self._begins = pace, None if isinstance(onward, BezierCurve) else onward
        self._pieces: list[Piece] = [onward] if isinstance(onward, BezierCurve) else []
        self._stops: list[tuple[int, float]] = []  # after so many pieces, seconds
        self._lanes: list[tuple[RoundedPolyline, int]] = []  # with so many pieces before
        through = bool(lap) and not any(line.rests for line in lap)
        lap_from = None
        if through:
            *groups, last = _groups([*to_lap, *lap])
            lap_from = self._fly_through(groups, last, len(lap))
        else:
            self._fly(_groups(to_lap))
            if lap:
                lap_from = len(self._pieces)
                self._fly(_groups(lap))
        if not self._pieces:
            self._pieces.append(_standing(to_lap[-1].way.points_m[-1]))
        self._lap_from, self._through = lap_from, through

    def _fly(self, groups: Sequence[Sequence[_Line]]) -> None:
        for group in groups:
            self._pieces.extend(self._smooth(group, None))
            self._end(group[-1])

    def _fly_through(self, groups: Sequence[Sequence[_Line]], last: Sequence[_Line], laps: int) -> int:
        self._fly(groups)
        curves = self._smooth(last, len(last) - laps)
        self._pieces.extend(curves)
        return len(self._pieces) - 1

    def _smooth(self, group: Sequence[_Line], lap: int | None) -> tuple[Piece, ...]:
        if all(len(line.way.points_m) < 2 for line in group):  # noqa: PLR2004 - a line
            return ()
        onward = None if self._pieces else self._begins
        return smooth_ways([line.way for line in group], self._pace, lap=lap, onward=onward)

    def _end(self, line: _Line) -> None:
        if line.held_s > 0.0:
            self._stops.append((len(self._pieces), line.held_s))
        if line.lanes is not None:
            self._lanes.append((line.lanes, len(self._pieces)))
            self._pieces.append(line.lanes)

    @property
    def moves(self) -> bool:
        """Whether there is any curve: who begins where the flight may end need not move."""
        return bool(self._pieces)

    @property
    def curve(self) -> JoinedCurve:
        """The whole curve."""
        cut = len(self._pieces) if self._lap_from is None else self._lap_from
        return JoinedCurve(tuple(_joined(part) for part in (self._pieces[:cut], self._pieces[cut:]) if part))

    @property
    def onward(self) -> tuple[FloatArray, FloatArray] | None:
        """First and second derivative with which laps end that are flown through."""
        if not self._through:
            return None
        _, slope, bend = self._pieces[-1].jet([self._pieces[-1].duration_s])
        return slope[0], bend[0]

    @property
    def _ends_s(self) -> list[float]:
        return list(accumulate((piece.duration_s for piece in self._pieces), initial=0.0))

    @property
    def stops(self) -> tuple[tuple[float, float], ...]:
        """Pairs (curve parameter, seconds)."""
        ends_s = self._ends_s
        return tuple((ends_s[count], held_s) for count, held_s in self._stops)

    @property
    def lanes(self) -> Iterator[tuple[RoundedPolyline, float]]:
        """Lanes, and the parameter at which they begin."""
        ends_s = self._ends_s
        return ((lanes, ends_s[count]) for lanes, count in self._lanes)


def _standing(place_m: FloatArray) -> BezierCurve:
    """The curve of who stays where the flight begins."""
    return BezierCurve(np.array([0.0, 1.0]), np.broadcast_to(place_m, (1, DEGREE + 1, 2)))


def _groups(lines: Sequence[_Line]) -> list[list[_Line]]:
    """Lines from rest to rest."""
    groups: list[list[_Line]] = [[]]
    for line in lines:
        groups[-1].append(line)
        if line.rests:
            groups.append([])
    return groups if groups[-1] or len(groups) == 1 else groups[:-1]


def _joined(pieces: Sequence[Piece]) -> Curve:
    return pieces[0] if len(pieces) == 1 else JoinedCurve(tuple(pieces))


def _planned(to_lap: Sequence[_Line], lap: Sequence[_Line], speed_m_s: float) -> Polyline:
    """All lines and lanes as one polyline."""
    parts: list[FloatArray] = []
    begins: list[int] = []
    for line in (*to_lap, *lap):
        begins.append(max(0, sum(map(len, parts)) - 1))
        parts.append(line.way.points_m)
        if line.lanes is not None:
            parts.append(line.lanes.corners_m)
    points = np.concatenate(parts)
    return Polyline(points, speed_m_s, (begins[len(to_lap)], len(points) - 1) if lap else None)
