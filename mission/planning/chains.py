"""Chains: all sequences of triangles of least cost between given ends, counted, ordered and picked by number.

Cheapest ways form an acyclic graph over states, for no transition is free. Two ways may be one sequence of triangles
and controls and differ in the states of the automaton only; they are one run. Where the states of the graph have at
most one successor for each control, and it begins in one state, that cannot happen, and the graph is counted as it is.
Elsewhere it is made deterministic: a node is then a triangle with the *set* of states that the sequence may have led
to. Either way sequences and ways through the nodes correspond one to one, and counting them is a sum over the steps
into each node, in Python's integers, which have no largest.

Loops from several heads are graphs apart, so that a sequence counts only where one and the same head closes it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from heapq import heappop, heappush
from itertools import pairwise

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray

Members = tuple[int, ...]
"""States of the united ways, ascending."""


@dataclass(frozen=True, eq=False)
class Ways:
    """The states and transitions on the cheapest ways from some states to others.

    Attributes:
        triangles: (n,) the triangle of each state.
        order: (n,) what orders states in one triangle, such as the automaton state.
        distances: (n,) how far each state is from the beginning.
        sources: (E,) the state that a transition leaves.
        controls: (E,) the control of T that it takes.
        targets: (E,) the state that it enters.
        ends: The states at which the ways end.
    """

    triangles: IntArray
    order: IntArray
    distances: FloatArray
    sources: IntArray
    controls: IntArray
    targets: IntArray
    ends: IntArray


@dataclass(frozen=True, eq=False)
class Chain:
    """A graph of nodes in which every way to a node is a sequence of triangles of its own.

    Attributes:
        triangles: The triangle of each node.
        begins: Where the steps into each node begin in ``sources`` and ``controls``; one more than nodes.
        sources: The node that a step comes from; for each node ordered by control, then by triangle.
        controls: The control that leads from there.
        ends: The nodes at which ways end, each with the ends (states of the united ways) that it stands for.
        counts: How many sequences lead to each node.
    """

    triangles: list[int]
    begins: list[int]
    sources: list[int]
    controls: list[int]
    ends: list[tuple[int, Members]]
    counts: list[int]

    def walk(self, node: int, rank: int) -> tuple[list[int], list[int]]:
        """The ``rank``-th sequence that ends in a node: its triangles and the controls between them.

        Sequences are ordered from their end: by the last control, then by the triangle it came from, then likewise
        before that.
        """
        triangles, controls = [self.triangles[node]], []
        while self.begins[node] < self.begins[node + 1]:
            for step in range(self.begins[node], self.begins[node + 1]):
                source = self.sources[step]
                if rank < self.counts[source]:
                    break
                rank -= self.counts[source]
            node = source
            triangles.append(self.triangles[node])
            controls.append(self.controls[step])
        return triangles[::-1], controls[::-1]


def chain(parts: Sequence[Ways]) -> Chain:
    """Unite ways, whose states are numbered on from part to part, into one chain of distinct sequences."""
    ways = _plain(parts[0] if len(parts) == 1 else _united(parts))
    return _as_it_is(ways) if _deterministic(ways) else _made_deterministic(ways)


def _united(parts: Sequence[Ways]) -> Ways:
    shifts = np.cumsum([0, *(len(part.triangles) for part in parts[:-1])]).tolist()
    return Ways(
        np.concatenate([part.triangles for part in parts]),
        np.concatenate([part.order for part in parts]),
        np.concatenate([part.distances for part in parts]),
        np.concatenate([part.sources + shift for part, shift in zip(parts, shifts, strict=True)]),
        np.concatenate([part.controls for part in parts]),
        np.concatenate([part.targets + shift for part, shift in zip(parts, shifts, strict=True)]),
        np.concatenate([part.ends + shift for part, shift in zip(parts, shifts, strict=True)]),
    )


def _plain(ways: Ways) -> Ways:
    """The same ways, with transitions of A that differ in their marks only as one transition."""
    rows = np.unique(np.column_stack((ways.sources, ways.controls, ways.targets)), axis=0).reshape(-1, 3)
    return replace(ways, sources=rows[:, 0], controls=rows[:, 1], targets=rows[:, 2])


def _deterministic(ways: Ways) -> bool:
    """Whether two ways are always two sequences."""
    again = (np.diff(ways.sources) == 0) & (np.diff(ways.controls) == 0)  # ordered by these
    return np.count_nonzero(ways.distances == 0) == 1 and not again.any()


def _as_it_is(ways: Ways) -> Chain:
    """The chain whose nodes are the states."""
    size = len(ways.triangles)
    node_of = np.empty(size, dtype=np.int64)
    states = np.lexsort((ways.order, ways.triangles, ways.distances))
    node_of[states] = np.arange(size)
    sources, targets = node_of[ways.sources], node_of[ways.targets]
    order = np.lexsort((ways.triangles[ways.sources], ways.controls, targets))
    begins = np.concatenate(([0], np.cumsum(np.bincount(targets, minlength=size)))).tolist()
    listed = sources[order].tolist()
    ends = ways.ends[np.lexsort((ways.order[ways.ends], ways.triangles[ways.ends]))]
    return Chain(
        triangles=ways.triangles[states].tolist(),
        begins=begins,
        sources=listed,
        controls=ways.controls[order].tolist(),
        ends=[(node, (end,)) for node, end in zip(node_of[ends].tolist(), ends.tolist(), strict=True)],
        counts=_counted(begins, listed),
    )


def _made_deterministic(ways: Ways) -> Chain:
    """The chain whose nodes are triangles with the sets of states that a sequence leads to."""
    onward: list[list[tuple[int, int]]] = [[] for _ in ways.triangles]
    for source, control, target in zip(
        ways.sources.tolist(), ways.controls.tolist(), ways.targets.tolist(), strict=True
    ):
        onward[source].append((control, target))
    at, distance_of = ways.triangles.tolist(), ways.distances.tolist()
    first: dict[int, list[int]] = {}
    for state in np.flatnonzero(ways.distances == 0).tolist():
        first.setdefault(at[state], []).append(state)
    # What has been found but not been made a node, by distance: each set with the steps that lead to it.
    waiting: dict[float, dict[Members, list[tuple[int, int, int]]]] = {0.0: {tuple(s): [] for s in first.values()}}
    queue = [0.0]
    triangles: list[int] = []
    members: list[Members] = []
    begins, sources, controls = [0], list[int](), list[int]()
    while queue:
        distance = heappop(queue)
        for states, steps in sorted(waiting.pop(distance).items(), key=lambda item: (at[item[0][0]], item[0])):
            node = len(triangles)
            triangles.append(at[states[0]])
            members.append(states)
            for control, _, source in sorted(steps):
                sources.append(source)
                controls.append(control)
            begins.append(len(sources))
            reached: dict[int, set[int]] = {}
            for state in states:
                for control, target in onward[state]:
                    reached.setdefault(control, set()).add(target)
            for control, targets in reached.items():
                found = tuple(sorted(targets))
                after = distance_of[found[0]]
                if after not in waiting:
                    waiting[after] = {}
                    heappush(queue, after)
                waiting[after].setdefault(found, []).append((control, triangles[node], node))
    ends = frozenset(ways.ends.tolist())
    closing = [(node, tuple(s for s in states if s in ends)) for node, states in enumerate(members)]
    listed = sorted(((node, found) for node, found in closing if found), key=lambda end: (triangles[end[0]], end[1]))
    return Chain(triangles, begins, sources, controls, listed, _counted(begins, sources))


def _counted(begins: list[int], sources: list[int]) -> list[int]:
    counts: list[int] = []
    for begin, end in pairwise(begins):
        counts.append(sum([counts[source] for source in sources[begin:end]]) if begin < end else 1)
    return counts
