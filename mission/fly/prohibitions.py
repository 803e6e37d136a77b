"""What another formula forbids: whether a way on which the vehicle goes meanwhile would violate it for good."""

from dataclasses import dataclass

import numpy as np

from mission.errors import MissionError
from mission.geometry.arrays import FloatArray
from mission.geometry.location import OUTSIDE, Locator
from mission.geometry.regions import Labelling
from mission.logic.automata.rabin import DEAD, Rabin
from mission.spec.domain import build_domain
from mission.spec.finding import listed
from mission.spec.model import MissionSpec
from mission.spec.specification import deterministic_of, of_mission

_ASIDE = np.array([(0.0, 0.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
"""The middle of a square, and its corners."""


@dataclass(frozen=True, eq=False)
class Prohibitions:
    """What a mission's specification forbids from now on.

    Attributes:
        locator: Of the triangles of its map.
        labelling: Their labels.
        automaton: Over the numbers of their letters.
    """

    locator: Locator
    labelling: Labelling
    automaton: Rabin

    @staticmethod
    def of(mission: MissionSpec) -> "Prohibitions | None":
        """Those of a mission; None where it has no automaton that is small enough, which whoever plans it will say."""
        try:
            partition, labelling = build_domain(mission)
            required = of_mission(mission, labelling.letters)
            whole = deterministic_of(required.formula, required.given, labelling.letters).whole
        except MissionError:
            return None
        return Prohibitions(Locator(partition), labelling, whole)

    def met(self, places_m: FloatArray, half_m: float) -> str:
        """What is met on a way that must not be met, in plain words; empty where nothing is.

        The middle of a square on the way is followed, and each corner by itself.

        Args:
            places_m: Shape (n, 2), close together.
            half_m: Half a side of the square.
        """
        for aside in half_m * _ASIDE[: 5 if half_m > 0.0 else 1]:
            state, before = self.automaton.initial, OUTSIDE
            for triangle in self.locator.triangle_at(places_m + aside).tolist():
                if state == DEAD:
                    break
                if triangle in (before, OUTSIDE):
                    continue
                before, letter = triangle, int(self.labelling.letter_of[triangle])
                state = int(self.automaton.targets[state, letter])
                if state == DEAD:
                    return self._named(letter)
        return ""

    def _named(self, letter: int) -> str:
        return listed(sorted(self.labelling.letters[letter])) or "what is in no region"
