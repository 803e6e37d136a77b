"""Whether a flight can spell a word that an automaton accepts, where only sets of triangles are known of its places.

The flight goes through *layers*, each a set of triangles that hold its place. It reads the label of each triangle that
it enters, and of the one that it begins in with standard semantics. In a layer it may change between triangles that
share a vertex, finitely often; to the next layer it keeps its triangle, silently. In the end it stays: it may change
triangle there for ever, and the label of the one that it is in is read again and again. A flight of laps goes from the
last layer of the lap to the first one, for ever: in its triangle silently, or into another of that layer. A triangle
that lies in all layers of the lap need not be left, and its label is read once a lap then.

All this is a graph on (layer, triangle, state of the automaton). A word is accepted if and only if a strong component
that can be reached holds an accepting state, a step on which a letter is read, and one on which time goes on.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from mission.geometry.arrays import BoolArray, IntArray
from mission.geometry.simplices import Partition
from mission.logic.automata.automaton import CompiledAutomaton


class Layers(NamedTuple):
    """Where a flight may be.

    Attributes:
        sets: The triangles of each layer, none empty.
        lap: The first layer of the lap and the one after its last; None where there is no lap.
    """

    sets: Sequence[Sequence[int]]
    lap: tuple[int, int] | None = None


class _Steps(NamedTuple):
    """Steps between places (E,): from, to, whether the label of the latter is read, and whether time goes on."""

    sources: IntArray
    targets: IntArray
    reads: BoolArray
    lasts: BoolArray


def spells(
    layers: Layers, partition: Partition, letter_of: IntArray, automaton: CompiledAutomaton, *, reads_first: bool
) -> bool:
    """Whether some word that the flight can spell is accepted.

    Args:
        layers: Where it may be; after a lap that is not the end, any number of laps is flown before it goes on.
        partition: The triangles.
        letter_of: Shape (M,), their letters.
        automaton: Over these letters.
        reads_first: Whether the label of the first triangle is read.
    """
    steps, triangles, first = _steps(layers, partition)
    states, places = automaton.states, len(triangles)
    every = np.arange(states)
    begun = automaton.initial
    edges: list[tuple[IntArray, IntArray, IntArray, IntArray]] = []  # sources, targets, and of each both marks
    for letter in (None, *np.unique(letter_of[triangles]).tolist()):
        rows = automaton.letters == letter
        read = (every, every) if letter is None else (automaton.sources[rows], automaton.targets[rows])
        heard = ~steps.reads if letter is None else steps.reads & (letter_of[triangles[steps.targets]] == letter)
        ends = [(at[heard][:, None] * states + of).ravel() for at, of in zip(steps[:2], read, strict=True)]
        edges.append((*ends, *(np.repeat(mark[heard], len(read[0])) for mark in steps[2:])))
    starts = [
        place * states + (_after(automaton, int(letter_of[triangles[place]])) if reads_first else begun)
        for place in range(first)
    ]
    begins = np.concatenate(starts)
    edges.append((np.full(len(begins), places * states), begins, *np.zeros((2, len(begins)), dtype=np.bool_)))
    sources, targets, *marks = (np.concatenate(column) for column in zip(*edges, strict=True))
    size = places * states + 1  # the last node is before the flight
    graph = coo_array((np.ones(len(sources), dtype=np.int8), (sources, targets)), shape=(size, size)).tocsr()
    reached = np.zeros(size, dtype=np.bool_)
    reached[breadth_first_order(graph, size - 1, return_predecessors=False)] = True
    _, component = connected_components(graph, directed=True, connection="strong")
    held = np.zeros((3, size), dtype=np.bool_)
    held[0, component[reached & np.append(np.tile(automaton.accepting, places), False)]] = True
    inner = reached[sources] & (component[sources] == component[targets])
    for row, mark in enumerate(marks, start=1):
        held[row, component[sources[inner & mark]]] = True
    return bool(held.all(axis=0).any())


def _after(automaton: CompiledAutomaton, letter: int) -> IntArray:
    """The states after a first letter."""
    rows = (automaton.letters == letter) & np.isin(automaton.sources, automaton.initial)
    return np.unique(automaton.targets[rows])


def _steps(layers: Layers, partition: Partition) -> tuple[_Steps, IntArray, int]:
    """All steps between places, the triangle of each place, and how many places the first layer has."""
    sets = [np.unique(np.array(each, dtype=np.int64)) for each in layers.sets]
    begins = np.cumsum([0, *map(len, sets)]).tolist()
    found: list[tuple[IntArray, IntArray, bool, bool]] = []

    def step(here: int, there: int, alike: BoolArray, *, reads: bool, lasts: bool) -> None:
        a, b = np.nonzero(alike)
        found.append((begins[here] + a, begins[there] + b, reads, lasts))

    last = len(sets) - 1
    lap = layers.lap or (last, last)
    for k, here in enumerate(sets):
        corners = partition.triangles[here]
        near = (corners[:, None, :, None] == corners[None, :, None, :]).any(axis=(2, 3))
        stays = k == last and lap[1] <= last
        step(k, k, near & (stays | ~np.eye(len(here), dtype=np.bool_)), reads=True, lasts=stays)
        if k < last:
            step(k, k + 1, here[:, None] == sets[k + 1], reads=False, lasts=False)
    if layers.lap is not None:
        head, tail = lap[0], lap[1] - 1
        same = sets[tail][:, None] == sets[head]
        unmoved = np.logical_and.reduce([np.isin(sets[head], each) for each in sets[head : tail + 1]])
        step(tail, head, same, reads=False, lasts=True)
        step(tail, head, ~same | (same & unmoved), reads=True, lasts=True)
    sources, targets = (np.concatenate([each[i] for each in found]) for i in (0, 1))
    counts = [len(each[0]) for each in found]
    reads, lasts = (np.repeat([each[i] for each in found], counts) for i in (2, 3))
    return _Steps(sources, targets, reads, lasts), np.concatenate(sets), len(sets[0])
