"""Labels of triangles: which regions each triangle belongs to."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, IntArray, frozen_ints
from mission.geometry.simplices import Partition


@dataclass(frozen=True, eq=False)
class Labelling:
    """The observation map o of Eq. 22, over the observations that the domain really has.

    Attributes:
        letters: The distinct observations, each a set of region names; the alphabet of every word of this domain.
        letter_of: Shape (M,), the index into ``letters`` of each triangle.
    """

    letters: tuple[frozenset[str], ...]
    letter_of: IntArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "letter_of", frozen_ints(self.letter_of))

    def label(self, triangle: int) -> frozenset[str]:
        """The region names of one triangle."""
        return self.letters[int(self.letter_of[triangle])]

    def triangles_of(self, name: str) -> IntArray:
        """Indices of the triangles that carry the region ``name``, ascending."""
        with_name = [i for i, letter in enumerate(self.letters) if name in letter]
        return np.flatnonzero(np.isin(self.letter_of, with_name))


def label_triangles(size: int, members: Mapping[str, BoolArray]) -> Labelling:
    """Label ``size`` triangles from one membership mask, shape (size,), for each region name.

    The letters are sorted by their names in the order of ``members``, the empty one first where it occurs, so equal
    regions give equal labellings.
    """
    names = tuple(members)
    if not names:
        return Labelling((frozenset(),), np.zeros(size, dtype=np.int64))
    # Eight regions to a byte: the table stays small for many regions on a fine mesh.
    table = np.packbits(np.stack([members[name] for name in names]), axis=0).T
    # Most triangles carry no region: they need no sorting.
    bare = ~table.any(axis=1)
    distinct, sorted_of = np.unique(table[~bare], axis=0, return_inverse=True)
    rows = np.unpackbits(distinct, axis=1, count=len(names))
    letters = tuple(frozenset(name for name, member in zip(names, row, strict=True) if member) for row in rows)
    letter_of = np.zeros(size, dtype=np.int64)
    letter_of[~bare] = sorted_of.reshape(-1) + int(bare.any())
    return Labelling((frozenset(), *letters) if bare.any() else letters, letter_of)


def union_of(partition: Partition, triangles: BoolArray | IntArray) -> shapely.Geometry:
    """What some triangles, by numbers or marked in an array of shape (M,), make together; metres."""
    return shapely.union_all(shapely.polygons(partition.corners_m[triangles]))
