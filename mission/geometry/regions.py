"""Labels of triangles: which regions each triangle belongs to."""

from dataclasses import dataclass

import numpy as np

from mission.geometry.arrays import IntArray, frozen_ints


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
