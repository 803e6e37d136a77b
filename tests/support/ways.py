"""Shortest ways: how tests search them, and maps with their true lengths by brute force.

The oracle shares nothing with the planner: segments between corners of obstacles and many points on the rims of what is
to be visited, of which shapely says whether they are free; and all orders of the visits.
"""

from dataclasses import dataclass
from itertools import pairwise, permutations

import numpy as np
import shapely
from scipy.sparse.csgraph import dijkstra

from mission.geometry.arrays import FloatArray
from mission.geometry.location import Locator
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.plan.best_runs import BestRuns
from mission.plan.costs import transition_weights
from mission.plan.crossing_maps import CrossingMaps
from mission.plan.progress import Grounds, StagesOfRuns
from mission.plan.shortest_way import RunSearch
from mission.planning.transition_system import TransitionSystem
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from mission.spec.specification import of_mission
from mission.steering.taut import TautPath, taut_path


@dataclass(frozen=True, eq=False)
class Found:
    """A run with its map."""

    search: RunSearch
    best: BestRuns

    @property
    def labelling(self) -> Labelling:
        return self.search.maps.labelling

    @property
    def partition(self) -> Partition:
        return self.search.maps.locator.partition

    @property
    def word(self) -> list[str]:
        """The labels of prefix and loop, equal neighbours once, each as a text."""
        run = self.best.runs[0]
        names = [" ".join(sorted(self.labelling.label(triangle))) for triangle in run.states]
        return [name for name, before in zip(names, [None, *names], strict=False) if name != before]

    @property
    def visits(self) -> list[str]:
        """The regions of the word, each where it comes first."""
        return list(dict.fromkeys(name for label in self.word for name in label.split()))

    @property
    def length_m(self) -> float:
        """From the start to the end of the first round."""
        assert self.best.way_costs is not None
        return sum(self.best.way_costs)


def search_of(spec: MissionSpec) -> RunSearch:
    partition, labelling = build_domain(spec)
    restricted = restricted_triangles(spec, labelling)
    locator, start = Locator(partition), spec.start.position_m
    triangle = int(locator.triangle_at(np.array([start]))[0])
    weights = transition_weights(partition, spec.search.cost, spec.flight.speed_m_s)
    system = TransitionSystem.from_partition(partition, labelling, restricted, weights)
    return RunSearch(system, CrossingMaps(spec, labelling, restricted, locator, start, triangle))


def found(spec: MissionSpec) -> Found:
    search = search_of(spec)
    return Found(search, search.best(of_mission(spec, search.system.letters)))


def taut_of(way: Found, spec: MissionSpec) -> TautPath:
    """The shortest path that does what a run does, with all of the tube."""
    maps = way.search.maps
    grounds = Grounds(way.partition, way.labelling, maps.restricted, spec.flight.tube_m)
    stages = StagesOfRuns(grounds, way.best.product.automaton, spec.semantics).of(way.best.runs[0])
    return taut_path(np.array(maps.start_m), stages.stages, lap=stages.lap, entries=stages.entries)


@dataclass(frozen=True, eq=False)
class DrawnMap:
    """A field with obstacles, and places to visit in any order."""

    field: shapely.Polygon
    obstacles: tuple[shapely.Polygon, ...]
    places: tuple[shapely.Polygon, ...]
    start: tuple[float, float]

    @staticmethod
    def random(seed: int, obstacles: int = 5, places: int = 3) -> "DrawnMap":
        rng = np.random.default_rng(seed)
        field, taken = shapely.box(0.0, 0.0, 120.0, 90.0), [shapely.Point(60.0, 8.0).buffer(4.0)]
        while len(taken) < 1 + obstacles + places:
            large = len(taken) <= obstacles
            half = rng.uniform(4.0, 15.0, 2) if large else rng.uniform(2.0, 5.0, 2)
            box = shapely.affinity.rotate(shapely.box(*-half, *half), rng.uniform(0.0, 180.0))
            box = shapely.affinity.translate(box, *rng.uniform((15.0, 15.0), (105.0, 75.0)))
            if field.contains(box) and all(box.distance(other) > 2.0 for other in taken):
                taken.append(box)
        return DrawnMap(field, tuple(taken[1 : 1 + obstacles]), tuple(taken[1 + obstacles :]), (60.0, 8.0))

    def mission(self, more: str = "") -> MissionSpec:
        def region(name: str, kind: str, shape: shapely.Polygon) -> str:
            corners = shapely.get_coordinates(shape)[:-1].tolist()
            return f"  {name}: {{kind: {kind}, polygon: {corners}}}\n"

        regions = [region(f"k{i}", "restricted", shape) for i, shape in enumerate(self.obstacles)]
        regions += [region(f"p{i}", "survey", shape) for i, shape in enumerate(self.places)]
        formula = " & ".join(f"F p{i}" for i in range(len(self.places)))
        text = (
            f"domain:\n  boundary: {shapely.get_coordinates(self.field)[:-1].tolist()}\n"
            f"{more}regions:\n{''.join(regions)}mission:\n  formula: {formula}\n"
            f"start:\n  position_m: {list(self.start)}\nflight: {{disturbance_m_s2: 0}}\nsearch: {{cost: distance}}\n"
        )
        return parse_mission(text.encode(), "random.yaml")

    def lengths_m(self, apart_m: float = 0.6) -> dict[tuple[str, ...], float]:
        """The length of a shortest way for each order of first visits, to the rims' points at a distance."""
        ends = [np.array([self.start])]
        for place in self.places:
            rim = place.exterior
            count = int(np.ceil(rim.length / apart_m))
            ends.append(shapely.get_coordinates(rim.interpolate(np.arange(count) * rim.length / count)))
        free = self.field.difference(shapely.union_all(self.obstacles))
        corners = shapely.get_coordinates(free)
        points = np.concatenate((*ends, corners))
        bounds = np.cumsum([0, *map(len, ends)]).tolist()
        first = bounds[-1]
        free = shapely.buffer(free, 1e-6)
        shapely.prepare(free)

        def between(some: FloatArray, others: FloatArray) -> FloatArray:
            pairs = np.stack(np.broadcast_arrays(some[:, None], others[None, :]), axis=2)
            lengths = np.linalg.norm(pairs[:, :, 0] - pairs[:, :, 1], axis=-1)
            seen = shapely.covers(free, shapely.linestrings(pairs.reshape(-1, 2, 2))).reshape(lengths.shape)
            return np.where(seen, lengths, np.inf)

        at_corners = between(points[first:], points[first:])
        among = dijkstra(np.where(np.isfinite(at_corners), at_corners, 0.0))
        to_corners = [between(points[a:b], points[first:]) for a, b in pairwise(bounds)]
        around = [(end[:, :, None] + among[None]).min(axis=1) for end in to_corners]

        def onward(i: int, j: int) -> FloatArray:
            direct = between(points[bounds[i] : bounds[i + 1]], points[bounds[j] : bounds[j + 1]])
            over = np.array([(row[None] + to_corners[j]).min(axis=1) for row in around[i]])
            least: FloatArray = np.minimum(direct, over)
            return least

        count = len(self.places)
        table = {(i, j): onward(i, j) for i in range(count + 1) for j in range(1, count + 1) if i != j}
        lengths = {}
        for order in permutations(range(1, count + 1)):
            reached = np.zeros(1)
            for before, after in pairwise((0, *order)):
                reached = (reached[:, None] + table[before, after]).min(axis=0)
            lengths[tuple(f"p{i - 1}" for i in order)] = float(reached.min())
        return lengths
