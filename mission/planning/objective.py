"""What makes one lasso better than another."""

from dataclasses import dataclass

import numpy as np

from mission.geometry.arrays import FloatArray

Rank = tuple[float, float]
"""Less is better; compared from the left."""


@dataclass(frozen=True)
class Objective:
    """How the costs of prefix and suffix are weighed.

    A suffix is repeated for ever, so it decides unless it is given a weight; among runs with the best suffix, the
    prefix does. With weights, the least sum of prefix and suffix, each times its weight, is best: with the number of
    laps as the weight of the suffix, all that is flown.

    Attributes:
        prefix_weight: At least 1.
        suffix_weight: At least 1; None where the suffix decides.

    Raises:
        ValueError: A weight is below 1.
    """

    prefix_weight: int = 1
    suffix_weight: int | None = None

    def __post_init__(self) -> None:
        if self.prefix_weight < 1 or (self.suffix_weight is not None and self.suffix_weight < 1):
            raise ValueError("prefix and suffix weigh at least 1")

    def rank(self, prefix: float, suffix: float) -> Rank:
        """The rank of a lasso by the costs of its parts."""
        if self.suffix_weight is None:
            return suffix, prefix
        return self.cost(prefix, suffix), 0.0

    def ranks(self, prefixes: FloatArray, suffixes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The ranks of many lassos, as two arrays."""
        if self.suffix_weight is None:
            return suffixes, prefixes
        return self.prefix_weight * prefixes + self.suffix_weight * suffixes, np.zeros_like(prefixes)

    def longest_suffix(self, rank: Rank, nearest: float) -> float:
        """The costliest suffix of lassos that are not worse than ``rank``; their prefixes cost ``nearest`` at least."""
        if self.suffix_weight is None:
            return rank[0]
        return (rank[0] - self.prefix_weight * nearest) / self.suffix_weight

    def cost(self, prefix: float, suffix: float) -> float:
        """The weighed sum; a suffix that decides has the weight 1 in it."""
        return self.prefix_weight * prefix + (self.suffix_weight or 1) * suffix


SUFFIX_DECIDES = Objective()
"""The best suffix, whatever leads to it."""
