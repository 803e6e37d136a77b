"""Problems of product and search by size, to be measured.

Meshes are Delaunay triangulations of random nodes; each region is a handful of triangles around a random place, one
triangle in fifty is restricted.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from mission.geometry.regions import label_triangles
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import triangulate_nodes
from mission.logic.automata.conjunction import Conjunction
from mission.plan.costs import transition_weights
from mission.planning.product import Product
from mission.planning.search import ShortestRuns, search
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Cost, Semantics
from tests.support.domains import random_nodes
from tests.support.required import required


def in_order(names: list[str]) -> str:
    return " & ".join(f"F ({name}" for name in names) + ")" * len(names)


def each(names: list[str]) -> str:
    return " & ".join(f"F {name}" for name in names)


def again_and_again(names: list[str]) -> str:
    return " & ".join(f"G F {name}" for name in names)


@dataclass(frozen=True)
class Case:
    """A search by its size: regions of some triangles each, and the states that its automaton has.

    Recurrent formulas are searched with all their acceptance sets, so that loops are the best tours in any order.
    ``bar`` says how many times as long as scipy's Dijkstra over the triangles the whole search may take for each state.
    """

    name: str
    triangles: int
    formula_of: Callable[[list[str]], str]
    regions: int
    region_size: int
    states: int
    bar: float
    cost: Cost = Cost.TRANSITIONS


CASES = (
    Case("10,000 triangles x 9 states", 10_000, in_order, 8, 5, 9, 4),
    Case("100,000 triangles x 9 states", 100_000, in_order, 8, 5, 9, 4),
    Case("100,000 triangles x 32 states", 100_000, each, 5, 5, 32, 4),
    Case("10,000 triangles x 256 states", 10_000, each, 8, 5, 256, 4),
    Case("100,000 triangles, best tour of 3 regions of 1,000", 100_000, again_and_again, 3, 1000, 1, 150),
    Case("the same by distance", 100_000, again_and_again, 3, 1000, 1, 150, Cost.DISTANCE),
    Case("100,000 triangles, best tour of 5 regions of 1,000", 100_000, again_and_again, 5, 1000, 1, 150),
    Case("100,000 triangles, best tour of 8 regions of 5", 100_000, again_and_again, 8, 5, 1, 150),
)


def mesh(triangles: int) -> Partition:
    """About as many triangles as asked for: twice the nodes."""
    return triangulate_nodes(random_nodes(1, triangles // 2 + 10))


def problem(case: Case) -> tuple[TransitionSystem, Conjunction, int]:
    """The transition system, the automaton over its letters, and the triangle to start from."""
    partition, rng = mesh(case.triangles), np.random.default_rng(2)
    centres = partition.corners_m.mean(axis=1)
    places = rng.uniform((15.0, 10.0), (135.0, 90.0), (case.regions, 2))
    members = {}
    for i, place in enumerate(places):
        members[f"r{i}"] = np.zeros(partition.size, dtype=np.bool_)
        members[f"r{i}"][np.argsort(((centres - place) ** 2).sum(axis=1))[: case.region_size]] = True
    bare = ~np.any(list(members.values()), axis=0)
    restricted = bare & (rng.random(partition.size) < 0.02)
    labelling = label_triangles(partition.size, members | {"k": restricted})
    weights = transition_weights(partition, case.cost, 1.0)
    system = TransitionSystem.from_partition(partition, labelling, restricted, weights)
    automaton = required(f"{case.formula_of(list(members))} & G !k", labelling.letters)
    assert automaton.size == case.states
    return system, automaton, int(np.flatnonzero(bare & ~restricted)[0])


def searched(system: TransitionSystem, automaton: Conjunction, start: int) -> ShortestRuns:
    """Product and search; the last run is looked up, so that all are counted."""
    runs = search(Product(system, automaton, start, Semantics.STANDARD))
    _ = runs[runs.count - 1]
    return runs


def dijkstra_of(system: TransitionSystem, start: int) -> Callable[[], object]:
    """Scipy's Dijkstra from a triangle to all, over the same weights: the unit that searches are measured in."""
    rows, controls = np.nonzero(system.successors[:, 1:] >= 0)
    weights = system.weights[rows, controls + 1].astype(np.float64)
    matrix = csr_array((weights, (rows, system.successors[rows, controls + 1])), shape=(system.size, system.size))
    return partial(dijkstra, matrix, indices=start, return_predecessors=True)
