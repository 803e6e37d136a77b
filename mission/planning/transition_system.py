"""Transition systems as arrays: T of a partition (paper, Eq. 22), and others with more controls."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from mission.geometry.arrays import BoolArray, IntArray, frozen_ints
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition

CONTROLS = 4
"""Of T: u_0 stays; u_1 to u_3 leave through the facet opposite the first to third vertex."""


@dataclass(frozen=True, eq=False)
class TransitionSystem:
    """Deterministic: a state and a control have at most one successor.

    Attributes:
        successors: Shape (M, W), the state that each of W controls leads to; -1 where the control is not admissible.
            States of T are triangles, and it has four controls.
        letter_of: Shape (M,), index of each state's observation in ``letters``.
        letters: The observations of the domain.
        weights: Shape (M, W), what each transition costs, in whole units and at least 1, of controls that are not
            admissible too; 1 by default, so that a run costs as much as it has transitions. Whole numbers make ties
            exact, and a stay that is not free makes no loop free.

    Raises:
        ValueError: A weight is below 1.
    """

    successors: IntArray
    letter_of: IntArray
    letters: tuple[frozenset[str], ...]
    weights: IntArray = field(default_factory=lambda: np.ones((1, 1), dtype=np.int64))

    def __post_init__(self) -> None:
        object.__setattr__(self, "successors", frozen_ints(self.successors))
        object.__setattr__(self, "letter_of", frozen_ints(self.letter_of))
        object.__setattr__(self, "weights", frozen_ints(np.broadcast_to(self.weights, self.successors.shape)))
        if (self.weights < 1).any():
            raise ValueError("a transition costs at least 1")

    @property
    def size(self) -> int:
        """Number of states, M."""
        return len(self.successors)

    @property
    def controls(self) -> int:
        """Number of controls, W."""
        return int(self.successors.shape[1])

    @cached_property
    def transitions(self) -> tuple[IntArray, IntArray]:
        """States and controls of all admissible transitions, (E,) each, ordered by state and then by control."""
        states, controls = np.nonzero(self.successors >= 0)
        return states, controls

    @cached_property
    def uniform(self) -> bool:
        """Whether all transitions cost the same."""
        return bool((self.weights == self.weights[0, 0]).all())

    def without(self, states: Sequence[int]) -> "TransitionSystem":
        """The same where no control leads into some states."""
        kept = np.where(np.isin(self.successors, states), -1, self.successors)
        return TransitionSystem(kept, self.letter_of, self.letters, self.weights)

    @staticmethod
    def from_partition(
        partition: Partition, labelling: Labelling, blocked: BoolArray, weights: IntArray | None = None
    ) -> "TransitionSystem":
        """One state for each triangle; no control leads into a ``blocked`` (M,) one; ``weights`` (M, 4) or all 1."""
        across = partition.neighbours
        open_facet = (across >= 0) & ~blocked[across]
        successors = np.column_stack((np.arange(partition.size), np.where(open_facet, across, -1)))
        costs = np.ones((1, CONTROLS), dtype=np.int64) if weights is None else weights
        return TransitionSystem(successors, labelling.letter_of, labelling.letters, costs)
