"""The way back: what a flight of laps does after the last one.

The vehicle returns to a region of kind ``home``, or to the triangle in which it started where there is none, on the
best way on which nothing is violated: whatever number of laps was flown, neither the word up to the landing
nor any of its prefixes is bad (``mission.logic.automata.safety``), and no more is the word that goes on by staying
there. So the verdict "nothing was violated so far" holds to the end, although a formula that asks for laps for ever is
satisfied by no flight that ends. The way is found with the words that the tube around the laps may have spelled, and it
is proved like every other path, with the automaton of the bad prefixes in the place of that of the negated formula.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from mission.errors import NoPlanError
from mission.geometry.arrays import BoolArray
from mission.geometry.regions import Labelling
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.rabin import DEAD, Rabin
from mission.logic.automata.safety import Safety
from mission.planning.product import Product
from mission.planning.run import Run
from mission.planning.search import search
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import MissionSpec, RegionKind, Semantics
from mission.steering.certificate import Certificate


@dataclass(frozen=True, eq=False)
class Homeward:
    """The way back from the laps.

    Attributes:
        run: From the triangle in which the laps begin and end to the one in which the flight ends.
        certificate: The proof that nothing is violated on it, nor by staying at its end.
    """

    run: Run
    certificate: Certificate


def ends_of_flight(spec: MissionSpec, labelling: Labelling, restricted: BoolArray, start: int) -> BoolArray:
    """The triangles in which a flight of laps may end, shape (M,): those at home, or else the start triangle."""
    ends = np.zeros(len(labelling.letter_of), dtype=np.bool_)
    for region in spec.regions:
        if region.kind is RegionKind.HOME:
            ends[labelling.triangles_of(region.name)] = True
    ends &= ~restricted
    if not ends.any():
        ends[start] = True
    return ends


def ways_back(
    way: Callable[[Safety, BoolArray], Run | None],
    safety: Safety,
    reached: Mapping[int, int],
    *,
    lap_triangle: int,
    ends: BoolArray,
) -> Iterator[Run]:
    """Ways on which nothing is violated: a shortest one to where the flight may end, then staying where the laps end.

    Args:
        way: Finds a best run into some triangles on which nothing is violated.
        safety: The bad prefixes of the formula.
        reached: The states of ``safety`` (bits) that are possible after the laps, in each triangle.
        lap_triangle: The triangle in which the laps begin and end.
        ends: Shape (M,), where the flight may end.
    """
    states = 0
    for mask in reached.values():
        states |= mask
    onward = safety.after(state for state in range(len(safety.rows)) if states >> state & 1)
    if onward.initial == onward.bad:
        return
    here = np.arange(len(ends)) == lap_triangle
    for goal in (here,) if ends[lap_triangle] else (ends, here):
        run = way(onward, goal)
        if run is not None:
            yield run


def way_in(system: TransitionSystem, onward: Safety, start: int, goal: BoolArray) -> Run | None:
    """A best run that comes into some states (M,) and stays there without a bad prefix; None where there is none."""
    letters = len(system.letters)
    # Each letter twice: the second time for states of the goal.
    marked = replace(system, letter_of=system.letter_of + letters * goal, letters=(*system.letters, *system.letters))
    try:
        runs = search(Product(marked, _arriving(onward), start, Semantics.PAPER))
    except NoPlanError:
        return None
    return runs[0]


def _arriving(onward: Safety) -> Conjunction:
    """Accepts words without a bad prefix that are in the goal from some time on: letters of others are marked."""
    rows = np.where(onward.rows[:-1] == onward.bad, DEAD, onward.rows[:-1])
    elsewhere = np.broadcast_to(np.arange(2 * rows.shape[1]) < rows.shape[1], (len(rows), 2 * rows.shape[1]))
    return Conjunction.of((Rabin(np.hstack((rows, rows)), elsewhere * 1, ((1, 0),), onward.initial).reduced(),))
