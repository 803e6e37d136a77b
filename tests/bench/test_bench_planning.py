"""Product and search by size: time and memory of both together, without triangulation and translation.

    python -m pytest -m bench -s tests/bench/test_bench_planning.py

Meshes are Delaunay triangulations of random nodes; each region is a handful of triangles around a random place, one
triangle in fifty is restricted. Times are medians of nine rounds, by the wall and of the processor: where others use
the machine, the first says what they take too, so the bars are held against the second (nothing here runs in
parallel). The memory is the peak of what product and search allocate, in a round of its own.
"""

import tracemalloc
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import perf_counter, process_time

import numpy as np
import pytest

from mission.geometry.regions import label_triangles
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import triangulate_nodes
from mission.logic.automaton import CompiledAutomaton, compile_to_alphabet
from mission.logic.parser import parse_formula
from mission.logic.translate import translate
from mission.planning.product import Product
from mission.planning.search import ShortestRuns, search
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics
from mission.steering.facet_control import affine_fields, exit_velocities, stay_velocities
from tests.support.domains import random_nodes

pytestmark = [pytest.mark.bench, pytest.mark.timeout(600)]

ROUNDS = 9


def in_order(names: list[str]) -> str:
    return " & ".join(f"F ({name}" for name in names) + ")" * len(names)


def each(names: list[str]) -> str:
    return " & ".join(f"F {name}" for name in names)


def again_and_again(names: list[str]) -> str:
    return " & ".join(f"G F {name}" for name in names)


def mesh(triangles: int) -> Partition:
    """About as many triangles as asked for: twice the nodes."""
    return triangulate_nodes(random_nodes(1, triangles // 2 + 10))


def problem(
    triangles: int, formula_of: Callable[[list[str]], str], regions: int, region_size: int
) -> tuple[TransitionSystem, CompiledAutomaton, int]:
    partition, rng = mesh(triangles), np.random.default_rng(2)
    centres = partition.corners_m.mean(axis=1)
    places = rng.uniform((15.0, 10.0), (135.0, 90.0), (regions, 2))
    members = {}
    for i, place in enumerate(places):
        members[f"r{i}"] = np.zeros(partition.size, dtype=np.bool_)
        members[f"r{i}"][np.argsort(((centres - place) ** 2).sum(axis=1))[:region_size]] = True
    bare = ~np.any(list(members.values()), axis=0)
    restricted = bare & (rng.random(partition.size) < 0.02)
    labelling = label_triangles(partition.size, members | {"k": restricted})
    system = TransitionSystem.from_partition(partition, labelling, restricted)
    formula = f"{formula_of(list(members))} & G !k"
    automaton = compile_to_alphabet(translate(parse_formula(formula)), labelling.letters)
    return system, automaton, int(np.flatnonzero(bare & ~restricted)[0])


def searched(system: TransitionSystem, automaton: CompiledAutomaton, start: int) -> ShortestRuns:
    runs = search(Product(system, automaton, start, Semantics.STANDARD))
    assert runs[runs.count - 1].cost == runs.cost
    return runs


@dataclass(frozen=True)
class Case:
    triangles: int
    formula_of: Callable[[list[str]], str]
    regions: int
    region_size: int
    states: int
    bar_s: float


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(Case(10_000, in_order, 8, 5, 9, 0.020), id="10,000 x 9"),
        pytest.param(Case(100_000, in_order, 8, 5, 9, 0.5), id="100,000 x 9"),
        pytest.param(Case(100_000, each, 5, 5, 32, 2.0), id="100,000 x 32"),
        pytest.param(Case(10_000, each, 8, 5, 256, 2.0), id="10,000 x 256"),
        pytest.param(Case(100_000, again_and_again, 3, 1000, 4, 2.0), id="100,000 x 4, patrol of regions of 1,000"),
    ],
)
def test_bench_product_and_search(request: pytest.FixtureRequest, case: Case) -> None:
    arguments = problem(case.triangles, case.formula_of, case.regions, case.region_size)
    assert arguments[1].states == case.states
    wall_s, processor_s = [], []
    for _ in range(ROUNDS):
        begun_s, worked_s = perf_counter(), process_time()
        runs = searched(*arguments)
        processor_s.append(process_time() - worked_s)
        wall_s.append(perf_counter() - begun_s)
    tracemalloc.start()
    searched(*arguments)
    peak_mb = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()
    times = f"wall {1e3 * median(wall_s):7.1f} ms  processor {1e3 * median(processor_s):7.1f} ms"
    size = f"{peak_mb:6.1f} MB  cost {runs.cost:5}  {float(runs.count):.1e} runs"
    print(f"\n{request.node.callspec.id:40} {times} (bar {1e3 * case.bar_s:4.0f})  {size}")
    assert median(processor_s) < case.bar_s


def test_bench_fields() -> None:
    partition = mesh(100_000)
    _ = partition.incentres_m, partition.edge_lengths_m  # the geometry is there before the fields
    times = []
    for _ in range(ROUNDS):
        begun_s = perf_counter()
        velocities = np.concatenate((stay_velocities(partition, 1.0)[:, None], exit_velocities(partition, 1.0)), axis=1)
        affine_fields(partition.corners_m[:, None], velocities)
        times.append(perf_counter() - begun_s)
    print(f"\nall four fields of {partition.size:,} triangles: {1e3 * median(times):.0f} ms")
    assert min(times) < 1.0
