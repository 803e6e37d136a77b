"""The transition system T of a partition (paper, Eq. 22), as arrays."""

from dataclasses import dataclass

import numpy as np

from mission.geometry.arrays import BoolArray, IntArray, frozen_ints
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition

CONTROLS = 4
"""u_0 stays; u_1 to u_3 leave through the facet opposite the first to third vertex."""


@dataclass(frozen=True, eq=False)
class TransitionSystem:
    """Deterministic: a state and a control have at most one successor.

    Attributes:
        successors: Shape (M, 4), the triangle that each control leads to; -1 where the control is not admissible.
        letter_of: Shape (M,), index of each triangle's observation in ``letters``.
        letters: The observations of the domain.
    """

    successors: IntArray
    letter_of: IntArray
    letters: tuple[frozenset[str], ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "successors", frozen_ints(self.successors))
        object.__setattr__(self, "letter_of", frozen_ints(self.letter_of))

    @property
    def size(self) -> int:
        """Number of states, M."""
        return len(self.successors)

    @staticmethod
    def from_partition(partition: Partition, labelling: Labelling, blocked: BoolArray) -> "TransitionSystem":
        """One state for each triangle; no control leads into a ``blocked`` (M,) one."""
        across = partition.neighbours
        open_facet = (across >= 0) & ~blocked[across]
        successors = np.column_stack((np.arange(partition.size), np.where(open_facet, across, -1)))
        return TransitionSystem(successors, labelling.letter_of, labelling.letters)
