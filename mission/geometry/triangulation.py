"""The Delaunay triangulation of nodes (the paper's way), and which edges are in a mesh.

The order of the triangles and of the vertices in each is scipy's, which for the paper's nodes is the paper's.
"""

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay, QhullError

from mission.decimals import decimal
from mission.errors import GeometryError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.simplices import ROUNDING, Partition

SLIVER = 1e-4
"""A triangle is degenerate where its smallest height is less than this part of its longest side."""


def triangulate_nodes(nodes_m: FloatArray) -> Partition:
    """Delaunay triangulation of the convex hull of nodes.

    Nodes on a straight side of the hull are seldom exactly in line, and Delaunay then puts triangles of rounding
    height between them and the side. Those are peeled off; whatever else scipy gives is kept, in its order.

    Args:
        nodes_m: Shape (V, 2), ENU, metres; V at least 3, not all in line.

    Raises:
        GeometryError: If no triangle comes out, or one has no area.
    """
    nodes = np.asarray(nodes_m, dtype=np.float64)
    if nodes.ndim != 2 or nodes.shape[1] != 2 or not np.isfinite(nodes).all():  # noqa: PLR2004 - the plane
        raise GeometryError("nodes must be finite points of the plane, shape (V, 2)")
    if len(nodes) < 3:  # noqa: PLR2004 - a triangle
        raise GeometryError(f"{len(nodes)} nodes do not make a triangle; three is the least")
    try:
        mesh = Delaunay(nodes)
    except QhullError as error:
        raise GeometryError("the nodes all lie on one line") from error
    triangles = np.asarray(mesh.simplices, dtype=np.int64)
    neighbours = np.asarray(mesh.neighbors, dtype=np.int64)
    keep = _without_rounding(nodes, triangles, neighbours)
    if not keep.any():
        raise GeometryError("the nodes all lie on one line")
    return selected(nodes, triangles, neighbours, keep)


@dataclass(frozen=True, eq=False)
class EdgesInMesh:
    """Edges of polygons as links between vertices of a triangulation.

    An edge that passes through vertices counts as the shorter links between them.

    Attributes:
        links: Shape (L, 2), vertex indices.
        edge_of: Shape (L,), the edge that each link belongs to.
        present: Shape (L,), whether the link is an edge of the triangulation.
    """

    links: IntArray
    edge_of: IntArray
    present: BoolArray

    @classmethod
    def of(cls, mesh: Partition, edges_m: FloatArray) -> "EdgesInMesh":
        """Find edges, shape (E, 2, 2), in a triangulation.

        Raises:
            GeometryError: If an end of an edge is no vertex of it.
        """
        closeness = ROUNDING * mesh.extent_m
        tree = shapely.STRtree(shapely.points(mesh.vertices_m))
        edges, vertices = tree.query(shapely.linestrings(edges_m), predicate="dwithin", distance=closeness)
        begins, along = edges_m[edges, 0], edges_m[edges, 1] - edges_m[edges, 0]
        shares = ((mesh.vertices_m[vertices] - begins) * along).sum(axis=1)
        order = np.lexsort((shares, edges))
        edges, vertices = edges[order], vertices[order]
        _refuse_ends_off_vertices(edges_m, edges, mesh.vertices_m[vertices], closeness)
        inner = edges[:-1] == edges[1:]
        links = np.stack((vertices[:-1], vertices[1:]), axis=1)[inner].astype(np.int64)
        count = len(mesh.vertices_m)
        present = np.isin(edge_keys(links, count), facet_keys(mesh.triangles, count))
        return cls(links, edges[:-1][inner].astype(np.int64), present)

    @property
    def missing(self) -> IntArray:
        """Indices of the edges that do not come out, ascending."""
        return np.unique(self.edge_of[~self.present])


def parted(mesh: Partition, walls: BoolArray) -> tuple[IntArray, IntArray]:
    """The pieces that some of its edges cut a mesh into, each wholly inside or outside of what they bound.

    Args:
        mesh: M triangles.
        walls: Which facets are such edges, shape (M, 3).

    Returns:
        The piece of each triangle, shape (M,), and the widest triangle of each piece, by whose incentre a piece is
        judged: slivers beside a wall are never judged by rounding.
    """
    open_facets = (mesh.neighbours >= 0) & ~walls
    rows, facets = np.nonzero(open_facets)
    links = coo_array((np.ones(len(rows)), (rows, mesh.neighbours[rows, facets])), shape=(mesh.size, mesh.size))
    pieces, piece_of = connected_components(links, directed=False)
    widest = np.empty(pieces, dtype=np.int64)
    ascending = np.argsort(mesh.inradii_m, kind="stable")
    widest[piece_of[ascending]] = ascending
    return piece_of.astype(np.int64), widest


def slivers(partition: Partition) -> IntArray:
    """Indices of the degenerate triangles: smallest height less than ``SLIVER`` of the longest side."""
    return np.flatnonzero(partition.heights_m.min(axis=1) < SLIVER * partition.edge_lengths_m.max(axis=1))


def _without_rounding(nodes: FloatArray, triangles: IntArray, neighbours: IntArray) -> BoolArray:
    """Mask of the triangles that stay when those of rounding height are peeled off from the hull inwards."""
    corners = nodes[triangles]
    sides = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    doubled = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    heights = doubled / np.linalg.norm(sides, axis=-1).max(axis=1)
    flat = heights <= ROUNDING * float(np.ptp(nodes, axis=0).max())
    keep = np.ones(len(triangles), dtype=np.bool_)
    while True:
        at_rim = ((neighbours < 0) | ~keep[neighbours]).any(axis=1)
        peeled = keep & flat & at_rim
        if not peeled.any():
            return keep
        keep &= ~peeled


def selected(vertices: FloatArray, triangles: IntArray, neighbours: IntArray, keep: BoolArray) -> Partition:
    """The kept triangles as a partition of their own."""
    # Index -1 (no neighbour) picks the last entry, which maps to -1.
    renumbered = np.append(np.where(keep, np.cumsum(keep) - 1, -1), -1)
    return Partition(vertices, triangles[keep], renumbered[neighbours[keep]])


def _refuse_ends_off_vertices(edges_m: FloatArray, edge_of: IntArray, found_m: FloatArray, closeness: float) -> None:
    """Raise unless the first and the last of the vertices found along each edge (in its order) are its ends."""
    numbers = np.arange(len(edges_m))
    first, last = np.searchsorted(edge_of, numbers), np.searchsorted(edge_of, numbers, "right") - 1
    bounded = np.full_like(edges_m, np.inf)
    some = first <= last
    bounded[some] = found_m[np.stack((first[some], last[some]), axis=1)]
    off = (np.linalg.norm(bounded - edges_m, axis=-1) > closeness).reshape(-1)
    if off.any():
        x, y = edges_m.reshape(-1, 2)[int(np.argmax(off))]
        raise GeometryError(f"the corner ({decimal(x)}, {decimal(y)}) is no vertex of the mesh")


def edge_keys(links: IntArray, vertices: int) -> IntArray:
    """One integer for each undirected edge; shape (..., 2) in, (...) out."""
    keys: IntArray = np.minimum(links[..., 0], links[..., 1]) * vertices + np.maximum(links[..., 0], links[..., 1])
    return keys


def facet_keys(triangles: IntArray, vertices: int) -> IntArray:
    """Keys of all facets, shape (M, 3), each opposite the corner of its number."""
    ends = np.stack((np.roll(triangles, -1, axis=1), np.roll(triangles, -2, axis=1)), axis=-1)
    return edge_keys(ends, vertices)
