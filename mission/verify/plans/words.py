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
    """Steps between places (E,): from, to, whether time goes on, and whether the label of the latter is read."""

    sources: IntArray
    targets: IntArray
    lasts: BoolArray
    reads: BoolArray


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
    steps, letters = _steps(layers, partition, letter_of, reads_first=reads_first)
    states, size = automaton.states, len(letters) * automaton.states
    edges: list[tuple[IntArray, ...]] = []  # sources, targets, and of each both marks
    for letter in (None, *np.unique(letters).tolist()):
        rows = automaton.letters == letter
        silent = (np.arange(states),) * 2
        read = silent if letter is None else (automaton.sources[rows], automaton.targets[rows])
        heard = ~steps.reads if letter is None else steps.reads & (letters[steps.targets] == letter)
        ends = [(at[heard][:, None] * states + of).ravel() for at, of in zip(steps[:2], read, strict=True)]
        edges.append((*ends, *(np.repeat(mark[heard], len(read[0])) for mark in steps[2:])))
    sources, targets, *marks = (np.concatenate(column) for column in zip(*edges, strict=True))
    graph = coo_array((np.ones(len(sources), dtype=np.int8), (sources, targets)), shape=(size, size)).tocsr()
    reached = np.zeros(size, dtype=np.bool_)
    for begun in automaton.initial.tolist():  # where the flight has not begun, at the place of number 0
        reached[breadth_first_order(graph, begun, return_predecessors=False)] = True
    _, component = connected_components(graph, directed=True, connection="strong")
    held = np.zeros((3, size), dtype=np.bool_)
    held[0, component[reached & np.tile(automaton.accepting, len(letters))]] = True
    inner = reached[sources] & (component[sources] == component[targets])
    for row, mark in enumerate(marks, start=1):
        held[row, component[sources[inner & mark]]] = True
    return bool(held.all(axis=0).any())


def _steps(layers: Layers, partition: Partition, letter_of: IntArray, *, reads_first: bool) -> tuple[_Steps, IntArray]:
    """All steps between places, and the letter of each place; the first one is before the flight, and has none."""
    sets = [np.unique(np.array(each, dtype=np.int64)) for each in layers.sets]
    begins = np.cumsum([1, *map(len, sets)]).tolist()
    found: list[tuple[IntArray, IntArray, BoolArray, BoolArray]] = []

    def step(here: int, there: int, alike: BoolArray, *, reads: bool, lasts: bool = False) -> None:
        a, b = np.nonzero(alike)
        found.append((begins[here] + a, begins[there] + b, np.full(len(a), lasts), np.full(len(a), reads)))

    begins.append(0)
    step(-1, 0, np.ones((1, len(sets[0])), dtype=np.bool_), reads=reads_first)
    last = len(sets) - 1
    lap = layers.lap or (last, last)
    for k, here in enumerate(sets):
        corners = partition.triangles[here]
        near = (corners[:, None, :, None] == corners[None, :, None, :]).any(axis=(2, 3))
        stays = k == last and lap[1] <= last
        step(k, k, near & (stays | ~np.eye(len(here), dtype=np.bool_)), reads=True, lasts=stays)
        if k < last:
            step(k, k + 1, here[:, None] == sets[k + 1], reads=False)
    if layers.lap is not None:
        head, tail = lap[0], lap[1] - 1
        same = sets[tail][:, None] == sets[head]
        unmoved = np.logical_and.reduce([np.isin(sets[head], each) for each in sets[head : tail + 1]])
        step(tail, head, same, reads=False, lasts=True)
        step(tail, head, ~same | (same & unmoved), reads=True, lasts=True)
    return _Steps(*(np.concatenate(each) for each in zip(*found, strict=True))), letter_of[np.concatenate(([0], *sets))]
