"""Why a tube is not proved to satisfy its formula, in plain words, from one violating flight inside it."""

from dataclasses import dataclass
from itertools import groupby

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.logic.automata.automaton import CompiledAutomaton
from mission.spec.model import Point
from mission.steering.enclosure import Enclosure, RegionDistance


@dataclass(frozen=True)
class Explanation:
    """What a violating flight does.

    Attributes:
        reason: In plain words, without a subject ("may cross K1 near ...").
        where_s: Steering time of the place to look at.
        where_m: The curve's position there.
        triangles: The triangles that the violating flight goes through, equal neighbours once.
    """

    reason: str
    where_s: float
    where_m: Point
    triangles: tuple[int, ...]


@dataclass(frozen=True)
class Lap:
    """The lap of a violating flight.

    Attributes:
        way: How it goes on and on, after the way to it: times, and the triangle from then on.
        knot: Index of the knot at which the lap begins.
    """

    way: tuple[tuple[float, int], ...]
    knot: int


def point(position_m: FloatArray) -> Point:
    """A row of an array as a point."""
    return float(position_m[0]), float(position_m[1])


def place(where_m: Point, where_s: float) -> str:
    """A place and its time as text."""
    return f"({where_m[0]:.2f}, {where_m[1]:.2f}) m at {where_s:.1f} s"


def explain(
    way: tuple[tuple[float, int], ...],
    enclosure: Enclosure,
    centres: IntArray,
    partition: Partition,
    labelling: Labelling,
    *,
    refutation: CompiledAutomaton,
    sure: bool,
    ignored: BoolArray,
    lap: Lap | None = None,
) -> Explanation:
    """Compare a violating flight with what the middle of the tube does.

    Args:
        way: The violating flight: times at which it goes on, and its triangle from then on.
        enclosure: The pieces of the curve.
        centres: Shape (K,), the triangle in which the curve is at the start of each piece.
        partition: The domain.
        labelling: Its labels.
        refutation: The automaton of the negated formula.
        sure: Whether the curve itself flies so, and not only something in its tube.
        ignored: Shape (M,), triangles that nobody wants to enter.
        lap: What the flight repeats for ever; None where it stays. What matters then is what recurs.
    """
    way = way if lap is None else (*way, *lap.way)
    triangles = tuple(triangle for triangle, _ in groupby(triangle for _, triangle in way))
    flown = {name: time for time, triangle in reversed(way) for name in labelling.label(triangle)}
    again = set(flown)
    if lap is not None:
        again = {name for _, triangle in lap.way for name in labelling.label(triangle)}
        planned = {name for triangle in set(centres[lap.knot :].tolist()) - {-1} for name in labelling.label(triangle)}
        if skipped := sorted(planned - again):
            inside = np.isin(centres, labelling.triangles_of(skipped[0])) & (np.arange(len(centres)) >= lap.knot)
            piece = int(np.flatnonzero(inside)[inside.sum() // 2])
            return _told("is not sure to enter {} in each lap, near {}", skipped[0], enclosure, piece, triangles)
    middle = {name for triangle in set(centres.tolist()) - {-1} for name in labelling.label(triangle)}
    missed = sorted(middle - flown.keys())
    extra = sorted(flown.keys() - middle, key=lambda name: (flown[name], name))
    if missed:
        inside = np.isin(centres, labelling.triangles_of(missed[0]))
        piece = int(np.flatnonzero(inside)[inside.sum() // 2])
        reason = "is not sure to enter {} near {}"
        return _told(reason, missed[0], enclosure, piece, triangles)
    if extra:
        piece = int(np.searchsorted(enclosure.knots_s, flown[extra[0]], side="right")) - 1
        return _told("may cross {} near {}", extra[0], enclosure, piece, triangles)
    repeats = [(letter, len(list(same))) for letter, same in groupby(labelling.label(t) for t in triangles)]
    word = ", ".join(
        (" & ".join(sorted(letter)) or "(none)") + (f" ({times} times)" if times > 1 else "")
        for letter, times in repeats
    )
    verb = "spells" if sure else "may spell"
    reason = f"{verb} the word {word}, which violates the specification"
    first = 0 if lap is None else lap.knot
    wanted = _heeded(refutation, labelling.letters) - again
    wanted -= {name for triangle in np.flatnonzero(ignored).tolist() for name in labelling.label(triangle)}
    wanted = {name for name in wanted if len(labelling.triangles_of(name))}
    if not wanted:
        return Explanation(reason, float(enclosure.knots_s[-1]), point(enclosure.points_m[-1]), triangles)
    points = enclosure.points_m[first:]
    nearest: list[tuple[float, str, int]] = []
    for name in sorted(wanted):
        marked = np.zeros(partition.size, dtype=np.bool_)
        marked[labelling.triangles_of(name)] = True
        distances = RegionDistance(partition, marked).of_chords(points, points)
        nearest.append((float(distances.min()), name, first + int(distances.argmin())))
    distance, name, piece = min(nearest)
    never = "it never enters" if lap is None else "its lap does not enter"
    reason += f"; {never} {', '.join(sorted(wanted))} (within {distance:.2f} m of {{}} near {{}})"
    return _told(reason, name, enclosure, piece, triangles)


def _heeded(refutation: CompiledAutomaton, letters: tuple[frozenset[str], ...]) -> set[str]:
    """The names that make a difference to the automaton, as far as the letters of the domain tell."""
    rows = [
        (refutation.sources[refutation.letters == i].tolist(), refutation.targets[refutation.letters == i].tolist())
        for i in range(len(letters))
    ]
    pairs = [
        (i, letters.index(letter - {name}), name)
        for i, letter in enumerate(letters)
        for name in letter
        if letter - {name} in letters
    ]
    ignored = {name for _, _, name in pairs} - {name for i, j, name in pairs if rows[i] != rows[j]}
    return {name for letter in letters for name in letter} - ignored


def _told(reason: str, name: str, enclosure: Enclosure, knot: int, triangles: tuple[int, ...]) -> Explanation:
    """An explanation whose reason names a region and the place of a knot."""
    where_s, where_m = float(enclosure.knots_s[knot]), point(enclosure.points_m[knot])
    return Explanation(reason.format(name, place(where_m, where_s)), where_s, where_m, triangles)
