"""Which visits of a run are made in earnest: the path goes well inside instead of cutting a corner.

A run asks only that a triangle is entered; its path may clip a corner by a few centimetres. That is enough for a point
that follows it exactly, and too little for a vehicle that may be a tube's width away, or that is to loiter there.
"""

from functools import reduce
from operator import or_

import numpy as np

from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.logic.automata.rabin import DEAD, Rabin
from mission.logic.formula.syntax import propositions
from mission.plan.covering import Passage
from mission.planning.run import Run
from mission.spec.model import MissionSpec, Region, RegionKind, Semantics
from mission.spec.specification import formula_of


def visits(inside: list[bool]) -> list[tuple[int, int]]:
    """First and last index of each unbroken stretch of True."""
    starts = [i for i, here in enumerate(inside) if here and (i == 0 or not inside[i - 1])]
    ends = [i for i, here in enumerate(inside) if here and (i == len(inside) - 1 or not inside[i + 1])]
    return list(zip(starts, ends, strict=True))


def earnest_visits(
    spec: MissionSpec, partition: Partition, labelling: Labelling, automaton: Rabin, run: Run
) -> dict[int, tuple[Region, ...]]:
    """Indices into ``run.states`` at which the path first settles: one, in the roomiest triangle, for each visit.

    With each are the regions that are visited there; there are none where the path only turns back.

    Visits count of survey and home regions that are entered (not of the one in which the flight starts), where the
    region asks for loitering, or where the visit moves the automaton on and the tube is not a line. Where the run
    leaves a triangle by the facet by which it came, the path settles in any case: it would touch the facet and turn.
    """
    tube = spec.flight.disturbance_m_s2 > 0.0
    moved = _moves_on(labelling, automaton, run, spec.semantics)
    chosen: dict[int, tuple[Region, ...]] = dict.fromkeys(_turns_back(run), ())
    for region in spec.regions:
        if region.kind is RegionKind.RESTRICTED or not (tube or region.loiter_s > 0.0):
            continue
        for first, last in visits([region.name in labelling.label(triangle) for triangle in run.states]):
            if first == 0 or not (region.loiter_s > 0.0 or any(moved[first : last + 1])):
                continue
            index = _roomiest(partition, run, first, last)
            chosen[index] = (*chosen.get(index, ()), region)
    return chosen


def covered_visits(
    spec: MissionSpec, partition: Partition, labelling: Labelling, automaton: Rabin, run: Run
) -> dict[int, list[Region]]:
    """Which regions are covered, by indices into ``run.states``.

    Of those that the mission names, each visit that moves the automaton on covers, in the roomiest triangle of the
    visit. A lap that begins and ends in one visit covers once. To enter a region that is everywhere moves no automaton
    on, and covers all the same.
    """
    named = propositions(formula_of(spec)) | set(spec.automaton.automaton.propositions if spec.automaton else ())
    moved = _moves_on(labelling, automaton, run, spec.semantics)
    loop, end = len(run.prefix), len(run.states)
    chosen: dict[int, list[Region]] = {}
    for region in spec.regions:
        if region.cover is None or region.name not in named:
            continue
        everywhere = all(region.name in letter for letter in labelling.letters)
        inside = [region.name in labelling.label(triangle) for triangle in run.states]
        parts = ((0, loop), (loop, end)) if run.recurrent else ((0, end),)
        found = [[(a + p, b + p) for a, b in visits(inside[p:q])] for p, q in parts]
        if run.recurrent and inside[loop]:
            head = found[1].pop(0)
            tails = [
                [found[part].pop()] if found[part] and found[part][-1][1] == stop - 1 else []
                for part, stop in ((0, loop), (1, end))
            ]
            # What leads to the first lap, or back to where it began, is a part of its first visit.
            moved[head[0]] = any(any(moved[a : b + 1]) for a, b in (head, *tails[0], *tails[1]))
            found[1].insert(0, head)
        for first, last in (visit for part in found for visit in part):
            if everywhere or any(moved[first : last + 1]):
                chosen.setdefault(_roomiest(partition, run, first, last), []).append(region)
    return chosen


def passage_at(labelling: Labelling, automaton: Rabin, run: Run, semantics: Semantics, index: int) -> Passage:
    """Which letters may be read, and which change nothing, once a run has come to one of its states.

    A letter is closed if the word of the run is accepted no longer with that letter in it there, and the run's own
    after it; in every lap, where the state is in the loop.
    """
    state, first, head = automaton.initial, 0 if semantics is Semantics.STANDARD else 1, len(run.prefix)
    letters = [int(labelling.letter_of[triangle]) for triangle in run.states]
    for letter in letters[first : index + 1]:
        state = int(automaton.targets[state, letter])
    begin, lap, own = letters[first : head + 1], [*letters[head + 1 :], letters[head]], letters[index]
    repeats = run.recurrent and index >= head
    at = index - head if repeats else index + 1 - first

    def is_closed(letter: int) -> bool:
        if letter == own or automaton.targets[state, letter] == DEAD:
            return letter != own
        if repeats:
            return not automaton.accepts(begin, [*lap[:at], letter, own, *lap[at:]])
        return not automaton.accepts([*begin[:at], letter, own, *begin[at:]], lap)

    after, marks = automaton.targets[state], automaton.marks[state]
    once = reduce(or_, (fin for fin, _ in automaton.pairs), 0) & ~marks[labelling.letter_of[run.states[index]]]
    idle = (after == state) & (marks & once == 0)
    closed = frozenset(filter(is_closed, range(len(labelling.letters))))
    return Passage(closed, frozenset(np.flatnonzero(idle).tolist()) - closed)


def _roomiest(partition: Partition, run: Run, first: int, last: int) -> int:
    """The state of a visit whose triangle has most room."""
    return max(range(first, last + 1), key=lambda i: float(partition.inradii_m[run.states[i]]))


def _turns_back(run: Run) -> set[int]:
    """Indices of the states that the run enters and leaves by one facet."""
    states, loop = run.states, len(run.prefix)
    after = [*states[1:], run.suffix[0]]
    turns = {i for i in range(1, len(states)) if states[i - 1] == after[i] != states[i]}
    if run.recurrent and run.suffix[-1] == after[loop] != states[loop]:
        turns.add(loop)  # from the second lap on
    return turns


def _moves_on(labelling: Labelling, automaton: Rabin, run: Run, semantics: Semantics) -> list[bool]:
    """Whether reading each state's label moves the automaton on, in the first rounds of the loop at least.

    It does where the state of the automaton changes, or where the loop meets an acceptance set that it has not met in
    this lap.
    """
    sets = reduce(or_, (inf for _, inf in automaton.pairs), 0)
    states, head = run.states, len(run.prefix)
    letters = [int(labelling.letter_of[triangle]) for triangle in states]
    moved = [False] * len(states)
    state = automaton.initial
    for index in range(0 if semantics is Semantics.STANDARD else 1, head + 1):
        after = int(automaton.targets[state, letters[index]])
        moved[index] = after != state
        state = after
    entered: set[int] = set()
    while state not in entered:  # the loop may go on moving the automaton for a few rounds
        entered.add(state)
        met = 0
        for index in (*range(head + 1, len(states)), head):
            after, borne = int(automaton.targets[state, letters[index]]), int(automaton.marks[state, letters[index]])
            moved[index] = moved[index] or after != state or borne & sets & ~met != 0
            state, met = after, met | borne
    return moved
