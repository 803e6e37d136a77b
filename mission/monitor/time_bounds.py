"""Bounds in seconds while they are flown: met, missed at some time, or open with so many seconds left."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from mission.logic.formula.syntax import Formula, propositions
from mission.logic.formula.word import Letter
from mission.logic.timed.behaviour import Piece, from_to, so_far, staying
from mission.logic.timed.judge import satisfied
from mission.logic.timed.margins import settled_s, unbroken

_MOST_PIECES: Final = 64
"""Of more, as on very many laps, it is not foreseen when they are settled, which takes time that a flight has not."""


@dataclass(frozen=True)
class BoundNow:
    """What is known of a formula with bounds at one time.

    Attributes:
        formula: As it is written.
        met: Whether it is met, or missed, whatever follows; None while it is open.
        at_s: When that was settled, s since the trajectory began; of one that is open, when it will be if the vehicle
            stays where it is, and None where that alone settles nothing.
        will: Whether it would be met then; None likewise.
    """

    formula: str
    met: bool | None
    at_s: float | None
    will: bool | None = None

    def text(self, now_s: float | None = None) -> str:
        """It in words, at a time since the trajectory began; afterwards, where there is none."""
        if self.met is not None:
            return f"{self.formula} {'met' if self.met else 'missed'}" + (
                "" if self.at_s is None else f" at {self.at_s:.1f} s"
            )
        if self.at_s is None or now_s is None:
            return f"{self.formula} open"
        return f"{self.formula} open, {max(0.0, self.at_s - now_s):.0f} s {'to go' if self.will else 'left'}"


class BoundWatch:
    """Follows formulas with bounds on one flight.

    Args:
        formulas: The formulas.
    """

    def __init__(self, formulas: Sequence[Formula]) -> None:
        self._formulas = tuple(formulas)
        self._letters: list[tuple[float, Letter]] = []
        self._names = frozenset[str]().union(*map(propositions, formulas))
        self._found: list[BoundNow] = [BoundNow(str(formula), None, None) for formula in formulas]

    def enter(self, t_s: float, label: Letter) -> None:
        """A label that holds from a time on, on the clock of the reports."""
        letter = label & self._names
        if self._formulas and not (self._letters and self._letters[-1][1] == letter):
            self._renew(t_s)
            self._letters.append((t_s, letter))
            pieces = self._pieces
            self._found = [_judged(pieces, *each) for each in zip(self._formulas, self._found, strict=True)]

    def now(self, t_s: float) -> tuple[BoundNow, ...]:
        """What is known at a time."""
        self._renew(t_s)
        return tuple(self._found)

    def missed(self, *, stays: bool) -> BoundNow | None:
        """The first that is missed if the flight ends now.

        Args:
            stays: Whether the vehicle stays where it is for ever; otherwise it flies laps, and what comes after the
                last region that is spoken of does not count.
        """
        if not self._letters:
            return None
        pieces = self._pieces
        for formula, found in zip(self._formulas, self._found, strict=True):
            kept = satisfied(staying(pieces), formula) if stays else unbroken(pieces, formula, pieces[-1].span[0][0])
            if not kept:
                return found if found.met is False else BoundNow(str(formula), met=False, at_s=None)
        return None

    def _renew(self, t_s: float) -> None:
        """What has come about by the passing of time alone."""
        if not self._letters:
            return
        since_s = t_s - self._letters[0][0]
        self._found = [
            BoundNow(each.formula, each.will, each.at_s)
            if each.met is None and each.at_s is not None and each.at_s <= since_s
            else each
            for each in self._found
        ]

    @property
    def _pieces(self) -> list[Piece]:
        began_s = Fraction(self._letters[0][0])
        times = [Fraction(t_s) - began_s for t_s, _ in self._letters]
        spans = zip(times, [*times[1:], times[-1] + 1], self._letters, strict=True)
        return [Piece(from_to(begin, end), letter, letter) for begin, end, (_, letter) in spans]


def _judged(pieces: Sequence[Piece], formula: Formula, before: BoundNow) -> BoundNow:
    """A formula after the last label was entered."""
    if before.met is not None:
        return before
    now_s = pieces[-1].span[0][0]
    verdict = satisfied(so_far(pieces, now_s), formula)
    if verdict is not None:
        return BoundNow(before.formula, verdict, float(now_s))
    at_s = settled_s(pieces, formula, from_s=now_s) if len(pieces) <= _MOST_PIECES else None
    return BoundNow(before.formula, None, at_s, None if at_s is None else satisfied(staying(pieces), formula))
