"""Ways from crossing point to crossing point of a mesh, as a transition system whose weights are lengths.

On each edge of a mesh lie a few points, its ends among them, and ways go straight through a triangle from one point of
its rim to another. The cheapest of them come near the shortest ways in the plane, the nearer, the more points there
are (Aleksandrov, Maheshwari and Sack, "Approximation algorithms for geometric shortest path problems", 2000), and bend
at the corners of what is in the way like these.

A state is a point with what is around it there: of the triangles that meet at the point, those of one letter that are
joined by edges. On the edge between two letters there are two states at one point, and the way from one to the other
is all but free. So the word of a way is that of the regions through which it goes.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import facet_keys
from mission.planning.transition_system import TransitionSystem

_NONE: Final = -1


@dataclass(frozen=True, eq=False)
class Spacing:
    """How many points are put on edges.

    Attributes:
        apart_m: Points on an edge are no farther apart, but for the most that there may be.
        fewest: Points between the ends of an edge at least.
        most: At most.
    """

    apart_m: float
    fewest: int
    most: int

    def between(self, lengths_m: FloatArray) -> IntArray:
        """How many points there are between the ends of edges of some lengths."""
        wanted = np.ceil(lengths_m / self.apart_m).astype(np.int64) - 1
        return np.clip(wanted, self.fewest, self.most)

    def ways(self, mesh: Partition) -> int:
        """About how many ways straight from point to point there are in a mesh."""
        counts = self.between(mesh.edge_lengths_m)
        following = np.roll(counts, -1, axis=1)
        return int((2 * counts * following + 3 * counts + 1).sum())


@dataclass(frozen=True, eq=False)
class Crossings:
    """Crossing points as a transition system.

    Attributes:
        system: States are ordered by the coordinates of their points; weights are lengths.
        points_m: Shape (N, 2), the point of each state.
        start: The state at which ways begin.
    """

    system: TransitionSystem
    points_m: FloatArray
    start: int


def crossings(
    mesh: Partition,
    letter_of: IntArray,
    letters: tuple[frozenset[str], ...],
    *,
    beginnings: IntArray,
    start_m: tuple[float, float],
    spacing: Spacing,
    unit_m: float,
    tolls: IntArray,
) -> Crossings:
    """Put points on the edges of a mesh.

    Args:
        mesh: M triangles.
        letter_of: Shape (M,), their letters.
        letters: The letters.
        beginnings: The triangles, all of one letter, in or at whose rim ways begin.
        start_m: Where.
        spacing: How many points there are.
        unit_m: The length that weighs 1; what is shorter weighs 1, too.
        tolls: Shape (letters, letters), what it costs to come from one letter to another, at least 1.
    """
    rims = _Rims.of(mesh, spacing)
    sides = _shared(mesh, rims)
    state_of, letter_here = _sectors(rims, sides, letter_of)
    places = np.append(_first_of(state_of, rims), [len(rims.points_m)])
    every = np.concatenate((rims.points_m, [start_m]))[places]
    letter_here = np.append(letter_here, letter_of[beginnings[0]])
    order = np.lexsort((letter_here, every[:, 1], every[:, 0]))
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    state_of, start = number[state_of], int(number[-1])
    points, letter_here = every[order], letter_here[order]

    near = rims.incidences[beginnings]
    reached = np.unique(state_of[near[near >= 0]])
    begin = np.stack((np.full_like(reached, start), reached))
    within = [*_straight_ways(rims, state_of), begin, begin[::-1]]
    across = _changes(rims, sides, state_of, letter_of)
    codes = [2 * _codes(way, len(points)) for way in within]
    sorted_codes = np.sort(np.concatenate((*codes, 2 * _codes(across, len(points)) + 1)))
    pairs, free = np.divmod(sorted_codes[np.diff(sorted_codes, prepend=-1) > 0], 2)
    moves = np.stack(np.divmod(pairs, len(points)))
    steps = points[moves[0]] - points[moves[1]]
    weights = np.maximum(1, np.rint(np.linalg.norm(steps, axis=1) / unit_m)).astype(np.int64)
    changes = free == 1
    weights[changes] = tolls[letter_here[moves[0, changes]], letter_here[moves[1, changes]]]
    return Crossings(_system(moves, weights, letter_here, letters), points, start)


def _codes(moves: IntArray, size: int) -> IntArray:
    """One number for each pair of states (2, N), in the order of sources and then of targets."""
    codes: IntArray = moves[0] * size + moves[1]
    return codes


@dataclass(frozen=True, eq=False)
class _Rims:
    """The points on the rims of triangles, going round each.

    Attributes:
        points_m: Shape (P, 2): the vertices, then those on edges, from the end of lower number on.
        most: Points between vertices at most.
        incidences: Shape (M, 3 (most + 1)), for each rim the numbers of its points, from vertex to vertex, counted
            through all rims; -1 where there are fewer points.
        triangle_of: Shape (I,), the triangle of each such number.
        point_of: Shape (I,), the point.
    """

    points_m: FloatArray
    most: int
    incidences: IntArray
    triangle_of: IntArray
    point_of: IntArray

    @staticmethod
    def of(mesh: Partition, spacing: Spacing) -> "_Rims":
        vertices, most = len(mesh.vertices_m), spacing.most
        keys, edge_of = np.unique(facet_keys(mesh.triangles, vertices), return_inverse=True)
        edge_of = edge_of.reshape(-1, 3)
        low, high = mesh.vertices_m[keys // vertices], mesh.vertices_m[keys % vertices]
        between = spacing.between(np.linalg.norm(high - low, axis=1))
        first = vertices + np.cumsum(between) - between
        edge = np.repeat(np.arange(len(keys)), between)
        rank = np.arange(len(edge)) - (first[edge] - vertices)
        shares = ((rank + 1) / (between[edge] + 1))[:, None]
        points = np.concatenate((mesh.vertices_m, low[edge] * (1.0 - shares) + high[edge] * shares))

        slots = np.full((mesh.size, 3, most + 1), _NONE, dtype=np.int64)
        slots[:, :, 0] = mesh.triangles
        for corner in range(3):
            edges = edge_of[:, (corner + 2) % 3]
            forward = mesh.triangles[:, corner] < mesh.triangles[:, (corner + 1) % 3]
            for place in range(most):
                turned = np.where(forward, place, between[edges] - 1 - place)
                slots[:, corner, place + 1] = np.where(place < between[edges], first[edges] + turned, _NONE)
        rims = slots.reshape(mesh.size, -1)
        incidences = np.full(rims.shape, _NONE, dtype=np.int64)
        there = rims >= 0
        incidences[there] = np.arange(int(there.sum()))
        return _Rims(points, most, incidences, np.nonzero(there)[0], rims[there])

    def sides(self, of: IntArray) -> IntArray:
        """What is given for slots, shape (M, S), along each side: shape (M, 3, most + 2), from vertex to vertex."""
        along = of.reshape(len(of), 3, self.most + 1)
        sides: IntArray = np.concatenate((along, np.roll(along[:, :, :1], -1, axis=1)), axis=2)
        return sides


def _shared(mesh: Partition, rims: _Rims) -> tuple[IntArray, IntArray]:
    """Incidences of one point with two triangles on both sides of an edge that it lies on: each pair once."""
    sides = rims.sides(rims.incidences)
    # The side from corner c to the next is the facet opposite the third corner.
    beyond = np.roll(mesh.neighbours, -2, axis=1)
    rows, corners = np.nonzero(beyond > np.arange(mesh.size)[:, None])
    here = sides[rows, corners]
    there = here >= 0
    other = np.broadcast_to(beyond[rows, corners][:, None], here.shape)[there]
    here = here[there]
    keys = rims.point_of * mesh.size + rims.triangle_of
    order = np.argsort(keys)
    opposite = order[np.searchsorted(keys[order], rims.point_of[here] * mesh.size + other)]
    return here, opposite


def _sectors(rims: _Rims, shared: tuple[IntArray, IntArray], letter_of: IntArray) -> tuple[IntArray, IntArray]:
    """The state of each incidence, shape (I,), and the letter of each state."""
    here, opposite = shared
    letters = letter_of[rims.triangle_of]
    same = letters[here] == letters[opposite]
    count = len(rims.point_of)
    links = coo_array((np.ones(int(same.sum())), (here[same], opposite[same])), shape=(count, count))
    states, state_of = connected_components(links, directed=False)
    letter_here = np.empty(states, dtype=np.int64)
    letter_here[state_of] = letters
    return state_of.astype(np.int64), letter_here


def _first_of(state_of: IntArray, rims: _Rims) -> IntArray:
    """The point of each state."""
    points = np.empty(int(state_of.max()) + 1, dtype=np.int64)
    points[state_of] = rims.point_of
    return points


def _straight_ways(rims: _Rims, state_of: IntArray) -> list[IntArray]:
    """Pairs of states, shape (2, N), between which a way leads straight through a triangle or along its rim."""
    slots = rims.incidences.shape[1]
    place = np.arange(slots)
    side, at_vertex = place // (rims.most + 1), place % (rims.most + 1) == 0
    on = np.stack([(side == number) | (at_vertex & (side == (number + 1) % 3)) for number in range(3)])
    first, second = np.nonzero(~(on[:, :, None] & on[:, None, :]).any(axis=0))
    # Most slots are empty where edges are short: what is there is asked before numbers are fetched.
    there = rims.incidences >= 0
    rows, ways = np.nonzero(there[:, first] & there[:, second])
    through = state_of[np.stack((rims.incidences[rows, first[ways]], rims.incidences[rows, second[ways]]))]
    # Along a side from each point to the next that there is.
    along = rims.sides(rims.incidences).reshape(-1, rims.most + 2)
    row, column = np.nonzero(along >= 0)
    onward = np.flatnonzero(row[1:] == row[:-1])
    chain = state_of[along[row, column]]
    beside = np.stack((chain[onward], chain[onward + 1]))
    return [through, beside, beside[::-1]]


def _changes(rims: _Rims, shared: tuple[IntArray, IntArray], state_of: IntArray, letter_of: IntArray) -> IntArray:
    """Pairs of states at one point on the edge between two letters, shape (2, N), both ways."""
    here, opposite = shared
    differ: BoolArray = letter_of[rims.triangle_of[here]] != letter_of[rims.triangle_of[opposite]]
    over = state_of[np.stack((here[differ], opposite[differ]))]
    return np.concatenate((over, over[::-1]), axis=1)


def _system(
    moves: IntArray, weights: IntArray, letter_of: IntArray, letters: tuple[frozenset[str], ...]
) -> TransitionSystem:
    """A transition system of moves (2, N), each once, ordered by source and target; stays are control 0."""
    size = len(letter_of)
    counts = np.bincount(moves[0], minlength=size)
    column = np.arange(len(moves[0])) - (np.cumsum(counts) - counts)[moves[0]] + 1
    successors = np.full((size, int(counts.max(initial=0)) + 1), _NONE, dtype=np.int64)
    costs = np.full(successors.shape, max(1, int(weights.min(initial=1))), dtype=np.int64)
    successors[:, 0] = np.arange(size)
    successors[moves[0], column] = moves[1]
    costs[moves[0], column] = weights
    return TransitionSystem(successors, letter_of, letters, costs)
