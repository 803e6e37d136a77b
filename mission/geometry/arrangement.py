"""The arrangement of outlines: what they and their crossings cut the plane into, as vertices and segments.

Outlines as people have them nearly meet: corners that were rounded, borders that two tools drew. Whatever is closer
than a tolerance is made to meet: points become one, an edge bends to a vertex beside it, and two edges that cross share
a vertex there. The method is that of snap rounding with the given vertices in the place of a grid; see Hobby,
"Practical segment intersection with finite precision output" (1999).
"""

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from mission.errors import GeometryError
from mission.geometry.arrays import FloatArray, IntArray
from mission.geometry.rings import edge_crossings

_MOST_ROUNDS = 50
_NEARER = 0.6
"""Of the tolerance: how near a vertex lies to the edge that bends to it. Below 1 / sqrt(2), so that of two vertices
that are not joined each cannot lie on the other's edge to a third."""


@dataclass(frozen=True, eq=False)
class Arrangement:
    """Vertices and the segments between them; segments meet at vertices only, and no vertex lies nearer to a segment.

    Attributes:
        vertices_m: Shape (V, 2), ENU, metres.
        segments: Shape (S, 2), indices of vertices, each pair once.
    """

    vertices_m: FloatArray
    segments: IntArray


def arranged(edges_m: FloatArray, tolerance_m: float) -> Arrangement:
    """Make edges meet where they nearly do, and cut them where they cross.

    Args:
        edges_m: Shape (E, 2, 2): edge, end, xy.
        tolerance_m: What is closer than this is joined; an edge moves by no more in each of a few rounds.

    Raises:
        GeometryError: They do not settle: edges run beside each other at about the tolerance.
    """
    vertices = np.asarray(edges_m, dtype=np.float64).reshape(-1, 2)
    segments = np.arange(len(vertices), dtype=np.int64).reshape(-1, 2)
    nearer_m = _NEARER * tolerance_m
    for _ in range(_MOST_ROUNDS):
        vertices, segments = _joined(vertices, segments, tolerance_m)
        beside, vertex = _vertices_on_edges(vertices, segments, nearer_m)
        if len(beside):
            segments = _cut(vertices, segments, beside, vertex)
            continue
        pairs, places = edge_crossings(vertices[segments], nearer_m)
        if not len(pairs):
            return Arrangement(vertices, segments)
        fresh = len(vertices) + np.arange(len(pairs))
        vertices = np.concatenate((vertices, places))
        segments = _cut(vertices, segments, pairs.T.reshape(-1), np.tile(fresh, 2))
    raise GeometryError(
        f"the outlines do not settle into a mesh: some run beside each other at about {tolerance_m:.3g} m"
    )


def _joined(vertices: FloatArray, segments: IntArray, tolerance_m: float) -> tuple[FloatArray, IntArray]:
    """Points closer than the tolerance become the first of them; segments of no length and repeated ones go."""
    pairs = cKDTree(vertices).query_pairs(tolerance_m, output_type="ndarray")
    count = len(vertices)
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, group_of = connected_components(links, directed=False)
    _, first, number = np.unique(group_of, return_index=True, return_inverse=True)
    # Groups in the order of their first members, so that vertices keep the order in which outlines were given.
    order = np.argsort(first)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    mapped = place[number][segments]
    mapped = np.sort(mapped[mapped[:, 0] != mapped[:, 1]], axis=1)
    _, kept = np.unique(mapped, axis=0, return_index=True)
    return vertices[first[order]], mapped[np.sort(kept)].astype(np.int64)


def _vertices_on_edges(vertices: FloatArray, segments: IntArray, tolerance_m: float) -> tuple[IntArray, IntArray]:
    """Pairs of a segment and a vertex within the tolerance of it that is no end of it."""
    tree = shapely.STRtree(shapely.points(vertices))
    segment, vertex = tree.query(shapely.linestrings(vertices[segments]), predicate="dwithin", distance=tolerance_m)
    strange = (segments[segment] != vertex[:, None]).all(axis=1)
    return segment[strange].astype(np.int64), vertex[strange].astype(np.int64)


def _cut(vertices: FloatArray, segments: IntArray, cut: IntArray, at: IntArray) -> IntArray:
    """Segments that pass through the vertices they are cut at, in the order along them; the others as they are."""
    begins, ends = vertices[segments[cut, 0]], vertices[segments[cut, 1]]
    along = ((vertices[at] - begins) * (ends - begins)).sum(axis=1)
    order = np.lexsort((along, cut))
    numbers = np.arange(len(segments))
    owner = np.concatenate((numbers, cut[order], numbers))
    chain = np.concatenate((segments[:, 0], at[order], segments[:, 1]))
    rank = np.concatenate((np.zeros(len(segments)), np.ones(len(cut)), np.full(len(segments), 2.0)))
    sequence = np.lexsort((np.arange(len(owner)), rank, owner))
    owner, chain = owner[sequence], chain[sequence]
    links = np.stack((chain[:-1], chain[1:]), axis=1)
    inner: IntArray = links[owner[:-1] == owner[1:]]
    return inner
