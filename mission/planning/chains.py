"""Chains: all sequences of triangles of least cost between given ends, counted, ordered and picked by number.

Cheapest ways form an acyclic graph over states, for no transition is free. States have at most one successor for each
control, and ways begin in one state, so that sequences and ways correspond one to one, and counting them is a sum over
the steps into each state, in Python's integers, which have no largest.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray


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
        ends: The nodes at which ways end, each with the state of the ways that it is.
        counts: How many sequences lead to each node.
    """

    triangles: list[int]
    begins: list[int]
    sources: list[int]
    controls: list[int]
    ends: list[tuple[int, int]]
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


def chain(ways: Ways) -> Chain:
    """The chain whose nodes are the states of ways, of which none has two transitions of one control."""
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
        ends=list(zip(node_of[ends].tolist(), ends.tolist(), strict=True)),
        counts=_counted(begins, listed),
    )


def _counted(begins: list[int], sources: list[int]) -> list[int]:
    counts: list[int] = []
    for begin, end in pairwise(begins):
        counts.append(sum([counts[source] for source in sources[begin:end]]) if begin < end else 1)
    return counts
