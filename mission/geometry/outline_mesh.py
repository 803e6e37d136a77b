"""A mesh of its own for what some triangles of a partition are like: it does not show how fine the partition is.

Triangles are of one class or another, and only the outlines of the classes count: they are put together from the edges
between triangles of different classes, without the vertices on their straight parts, in the order of their coordinates.
So two partitions with the same outlines have the same mesh, to the last bit.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mission.errors import GeometryError
from mission.geometry.arrangement import arranged
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.location import Locator
from mission.geometry.refinement import refined
from mission.geometry.shapes import Area, edges_of, edges_within, narrowed, polygonal
from mission.geometry.simplices import ROUNDING, Partition

JOINED: Final = 1e-4
"""Of the extent: outlines that are closer are joined."""


@dataclass(frozen=True, eq=False)
class ClassedMesh:
    """Triangles with a class each.

    Attributes:
        partition: M triangles.
        class_of: Shape (M,).
    """

    partition: Partition
    class_of: IntArray


@dataclass(frozen=True, eq=False)
class Outlines:
    """What parts the classes of a partition; all edges of shape (E, 2, 2), straight, ordered by coordinates.

    Attributes:
        rims_m: Edges between triangles that are open and what is not.
        borders_m: Edges between open triangles of different classes.
        within: Finds triangles.
        classes: Shape (M,), the class of each triangle, -1 where it is not open.
    """

    rims_m: FloatArray
    borders_m: FloatArray
    within: Locator
    classes: IntArray

    @classmethod
    def of(cls, within: Locator, class_of: IntArray, blocked: BoolArray) -> "Outlines":
        """The outlines of the classes (M,) of triangles, of which some (M,) are not open."""
        partition = within.partition
        classes = np.where(blocked, -1, class_of)
        beyond = np.where(partition.neighbours >= 0, classes[partition.neighbours], -1)
        rows, facets = np.nonzero((beyond != classes[:, None]) & (classes[:, None] >= 0))
        at_rim = beyond[rows, facets] < 0
        once = at_rim | (rows < partition.neighbours[rows, facets])
        rows, facets, at_rim = rows[once], facets[once], at_rim[once]
        ends = np.stack(
            (partition.triangles[rows, (facets + 1) % 3], partition.triangles[rows, (facets + 2) % 3]), axis=1
        )
        edges, first = _straight(partition.vertices_m, ends, ROUNDING * partition.extent_m)
        return cls(_ordered(edges[at_rim[first]]), _ordered(edges[~at_rim[first]]), within, classes)

    def mesh(self, clearance_m: float, *, largest_share: float) -> ClassedMesh:
        """Mesh what is open.

        Args:
            clearance_m: Half the width of the squares that are to find room: what no centre of one can reach without
                touching a rim is left out.
            largest_share: The longest edge, as a part of the extent.

        Raises:
            GeometryError: Nothing is left, or what is left has no mesh of a bearable size.
        """
        area = self._area()
        rims, borders = self.rims_m, self.borders_m
        if clearance_m > 0.0:
            area = narrowed(area, clearance_m)
            if area.is_empty:
                raise GeometryError("no room is left between the rims")
            rims, borders = edges_of([area]), edges_within(borders, area)
        extent_m = float(np.ptp(rims.reshape(-1, 2), axis=0).max())
        arrangement = arranged(np.concatenate((rims, borders)), JOINED * extent_m)
        mesh = refined(arrangement, area, largest_m=largest_share * extent_m)
        triangles = self.within.triangle_at(mesh.inside_m)
        return ClassedMesh(mesh.partition, np.where(triangles >= 0, self.classes[triangles], -1)[mesh.face_of])

    def _area(self) -> Area:
        """What is open, put together from its rims."""
        faces = np.array(shapely.polygonize(shapely.linestrings(self.rims_m)).geoms)
        inside = self.within.triangle_at(shapely.get_coordinates(shapely.point_on_surface(faces)))
        return polygonal(shapely.union_all(faces[(inside >= 0) & (self.classes[inside] >= 0)]))


def _straight(vertices: FloatArray, ends: IntArray, tolerance_m: float) -> tuple[FloatArray, IntArray]:
    """Edges in a row on one line made one.

    Args:
        vertices: Shape (V, 2).
        ends: Shape (E, 2), their numbers: of each edge, its ends.
        tolerance_m: How far from a line is on it.

    Returns:
        The edges, shape (F, 2, 2), and of each the number of one that it is made of, shape (F,).
    """
    flat = ends.reshape(-1)
    order = np.argsort(flat, kind="stable")
    degrees = np.bincount(flat, minlength=len(vertices))
    twice = np.flatnonzero(degrees == 2)  # noqa: PLR2004 - two edges meet
    begins = (np.cumsum(degrees) - degrees)[twice]
    sides = order[np.stack((begins, begins + 1), axis=1)]
    away = vertices[flat[sides ^ 1]] - vertices[twice][:, None]
    lengths = np.hypot(away[..., 0], away[..., 1])
    off = np.abs(away[:, 0, 0] * away[:, 1, 1] - away[:, 0, 1] * away[:, 1, 0]) / lengths.max(axis=1)
    straight = (off <= tolerance_m) & ((away[:, 0] * away[:, 1]).sum(axis=1) < 0.0)
    joined = sides[straight] // 2
    links = coo_array((np.ones(len(joined)), (joined[:, 0], joined[:, 1])), shape=(len(ends), len(ends)))
    _, chain_of = connected_components(links, directed=False)
    kept = np.ones(len(vertices), dtype=np.bool_)
    kept[twice[straight]] = False
    loose = np.flatnonzero(kept[flat])
    places = loose[np.argsort(chain_of[loose // 2], kind="stable")].reshape(-1, 2)
    edges: FloatArray = vertices[flat[places]]
    return edges, places[:, 0] // 2


def _ordered(edges: FloatArray) -> FloatArray:
    """Edges, and the ends of each, in the order of their coordinates."""
    swapped = (edges[:, 0, 0] > edges[:, 1, 0]) | (
        (edges[:, 0, 0] == edges[:, 1, 0]) & (edges[:, 0, 1] > edges[:, 1, 1])
    )
    edges = np.where(swapped[:, None, None], edges[:, ::-1], edges)
    ordered: FloatArray = edges[np.lexsort(edges.reshape(-1, 4).T[::-1])]
    return ordered
