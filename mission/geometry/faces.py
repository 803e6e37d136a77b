"""The faces that segments cut a mesh into; each triangle lies wholly in one of them."""

from dataclasses import dataclass

import numpy as np
import shapely

from mission.errors import GeometryError
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.delaunay import Triangulation
from mission.geometry.shapes import Area
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import parted, selected


@dataclass(frozen=True, eq=False)
class FacedMesh:
    """The triangles of the faces that lie in a domain.

    Attributes:
        partition: M triangles.
        face_of: Shape (M,), the face of each.
        inside_m: Shape (F, 2), for each face a point well inside it, so that no rounding at its rim matters.
    """

    partition: Partition
    face_of: IntArray
    inside_m: FloatArray

    @classmethod
    def of(cls, partition: Partition) -> "FacedMesh":
        """A mesh in which each triangle is a face of its own."""
        return cls(partition, np.arange(partition.size), partition.incentres_m)

    def inside(self, area: Area) -> BoolArray:
        """Which triangles lie in an area whose rim parts faces; shape (M,)."""
        centres = self.inside_m
        # The bounds of an empty area are no numbers: nothing lies within.
        low, high = np.array(area.bounds, dtype=np.float64).reshape(2, 2)
        inside = np.asarray(((centres >= low) & (centres <= high)).all(axis=1))
        shapely.prepare(area)
        inside[inside] = shapely.contains_xy(area, centres[inside, 0], centres[inside, 1])
        return inside[self.face_of]


def faces_of(mesh: Triangulation, walls: BoolArray, domain: shapely.Geometry, origin_m: FloatArray) -> FacedMesh:
    """The faces in a domain; a face is judged by its widest triangle.

    Args:
        mesh: The triangles, those around the domain included.
        walls: Which sides of the triangles part faces, shape (M, 3); the domain's rim is among them.
        domain: The part of the plane that is kept.
        origin_m: Where the origin of both is, shape (2,): the faces come out there.

    Raises:
        GeometryError: No triangle lies in it.
    """
    triangles, neighbours = mesh.triangles, mesh.neighbours
    whole = Partition(mesh.vertices, triangles, neighbours)
    face_of, widest = parted(whole, walls)
    centres = whole.incentres_m[widest]
    inside = shapely.contains_xy(domain, *centres.T)
    if not inside.any():
        raise GeometryError("no triangle lies inside the boundary")
    keep = inside[face_of]
    used = np.zeros(len(mesh.vertices), dtype=np.bool_)
    used[triangles[keep]] = True
    number = np.cumsum(used) - 1
    partition = selected(mesh.vertices[used] + origin_m, number[triangles], neighbours, keep)
    return FacedMesh(partition, (np.cumsum(inside) - 1)[face_of[keep]], centres[inside] + origin_m)
