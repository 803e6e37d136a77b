"""What was proved of a curve and its tube, by ``prover``, or where the proof fails."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np

from mission.geometry.arrays import FloatArray, frozen_floats
from mission.spec.model import Point


@dataclass(frozen=True, eq=False)
class Certificate:
    """What was proved of a curve and its tube, or where the proof fails.

    Attributes:
        holds: Whether the claim is proved.
        reason: What was proved, or what fails, in plain words.
        where_s: Steering time at which it fails; None where it holds.
        where_m: The curve's position there.
        knots_s: Shape (K + 1,), the pieces that the proof is about.
        possible: K tuples: the triangles that the tube may touch during each piece, ascending.
        word: The labels in which the tube lies as a whole at some time, in order, equal neighbours once: what it surely
            spells, but for regions that it crosses where they are narrower than itself.
        clearance_m: Proved lower bound of the distance of the curve itself to every restricted triangle; None where
            nothing is restricted.
        tube_m: Half width of the tube on each axis.
        landing_m: How much farther from the end of the curve the claim holds while the vehicle lands there.
        frequencies: Number of waves of the curve.
        counterexample: Triangles of a violating flight, in order; empty unless a word is to blame.
    """

    holds: bool
    reason: str
    where_s: float | None
    where_m: Point | None
    knots_s: FloatArray
    possible: tuple[tuple[int, ...], ...]
    word: tuple[frozenset[str], ...]
    clearance_m: float | None
    tube_m: float
    frequencies: int
    counterexample: tuple[int, ...] = ()
    landing_m: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "knots_s", frozen_floats(self.knots_s))

    @property
    def tube_clearance_m(self) -> float | None:
        """Proved lower bound of the distance of the tube to every restricted triangle (its corners reach farthest)."""
        if self.clearance_m is None:
            return None
        return max(0.0, self.clearance_m - float(np.sqrt(2.0)) * self.tube_m)

    def to_json(self) -> dict[str, Any]:
        """The certificate as JSON values; pieces with the same triangles follow each other as one."""
        runs = [(possible, len(list(group))) for possible, group in groupby(self.possible)]
        ends = np.cumsum([0, *(length for _, length in runs)])
        return {
            "holds": self.holds,
            "reason": self.reason,
            "where_s": self.where_s,
            "where_m": None if self.where_m is None else list(self.where_m),
            "knots_s": self.knots_s[ends].tolist(),
            "possible": [list(possible) for possible, _ in runs],
            "word": [sorted(letter) for letter in self.word],
            "clearance_m": self.clearance_m,
            "tube_m": self.tube_m,
            "landing_m": self.landing_m,
            "frequencies": self.frequencies,
            "counterexample": list(self.counterexample),
        }

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> "Certificate":
        """The certificate that ``to_json`` wrote; raises KeyError, TypeError or ValueError where it is not one."""
        where = data["where_m"]
        return Certificate(
            holds=bool(data["holds"]),
            reason=str(data["reason"]),
            where_s=None if data["where_s"] is None else float(data["where_s"]),
            where_m=None if where is None else (float(where[0]), float(where[1])),
            knots_s=data["knots_s"],
            possible=tuple(tuple(int(t) for t in triangles) for triangles in data["possible"]),
            word=tuple(frozenset(map(str, letter)) for letter in data["word"]),
            clearance_m=None if data["clearance_m"] is None else float(data["clearance_m"]),
            tube_m=float(data["tube_m"]),
            frequencies=int(data["frequencies"]),
            counterexample=tuple(int(t) for t in data["counterexample"]),
            landing_m=float(data["landing_m"]),
        )
