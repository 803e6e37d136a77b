"""Bounds in seconds, judged on a log: when the vehicle was in a region for certain, and when it may have been."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import groupby, pairwise
from typing import Final

import numpy as np

from mission.geometry.location import OUTSIDE
from mission.logic.formula.syntax import Formula, propositions
from mission.logic.formula.word import Letter
from mission.logic.timed.behaviour import Piece, from_to, so_far, staying
from mission.logic.timed.judge import satisfied
from mission.logic.timed.margins import margin_s, settled_s, unbroken
from mission.spec.air_time import longest_text
from mission.verify.flown.over import Over
from mission.verify.flown.possible import Ground, plain_intervals
from mission.verify.flown.reach import Reaches

_NOTHING: Letter = frozenset()
_BETWEEN_M: Final = 0.5
_MOST_BEGINNINGS: Final = 12


@dataclass(frozen=True)
class BoundFlown:
    """A formula with bounds, and what became of it.

    Attributes:
        formula: As it is written.
        met: Whether the flight kept it; None where that cannot be told.
        margin_s: By how much each of its bounds could be tightened at once, for certain; below 0, by how much it would
            have to be wider; infinite where time makes no difference. None of laps, which go on.
        at_s: When that was settled, s since the trajectory began; None where it never was.
    """

    formula: str
    met: bool | None
    margin_s: float | None
    at_s: float | None


@dataclass(frozen=True)
class Timing:
    """When a flight was judged from and to.

    Attributes:
        began_s: When its trajectory began, at the earliest and at the latest.
        whole: Whether the log has it to its end, so that it stays where it came to rest.
        laps: Whether it flew laps, no time of which is the last.
    """

    began_s: tuple[float, float]
    whole: bool
    laps: bool


def beginnings(began_s: tuple[float, float], fastest_m_s: float) -> tuple[float, ...]:
    """Times at which a trajectory may have begun, the latest and the earliest first; little moves between them.

    Args:
        began_s: The earliest and the latest.
        fastest_m_s: How fast anything moves.
    """
    earliest_s, latest_s = began_s
    parts = min(_MOST_BEGINNINGS, math.ceil(fastest_m_s * (latest_s - earliest_s) / _BETWEEN_M))
    latest, *between = np.linspace(latest_s, earliest_s, 1 + parts).tolist()
    return (latest, *between[-1:], *between[:-1])


def air_time(longest_s: float | None, aloft_s: tuple[float, float] | None) -> tuple[BoundFlown, ...]:
    """What became of the time from arming to landing; nothing where nothing is asked for.

    Args:
        longest_s: How long it may be.
        aloft_s: How long it was, at least and at most; None where the log does not tell.
    """
    if longest_s is None:
        return ()
    name = longest_text(longest_s)
    if aloft_s is None:
        return (BoundFlown(name, None, None, None),)
    least_s, most_s = aloft_s
    met = True if most_s <= longest_s else False if least_s > longest_s else None
    return (BoundFlown(name, met, longest_s - most_s, None),)


def bounds_flown(
    formulas: Sequence[Formula], ground: Ground, reaches: Reaches, timing: Timing
) -> tuple[BoundFlown, ...]:
    """What became of formulas with bounds; no time that the log leaves open counts for certain.

    Args:
        formulas: The formulas.
        ground: What the flight is judged on.
        reaches: The reports, and how far the vehicle may have been off between them.
        timing: From when to when.
    """
    if not formulas:
        return ()
    told = list(_pieces(ground, reaches))
    begun = [_since(told, Fraction(began_s)) for began_s in sorted(set(timing.began_s))]
    found = []
    for formula in formulas:
        each = [_judged(formula, pieces, timing) for pieces in begun if pieces]
        first = each[0] if each else BoundFlown(str(formula), None, None, None)
        agreed = all(other.met is first.met for other in each)
        # Where it is not told when the trajectory began, what depends on that is not told either.
        margins = [other.margin_s for other in each if other.margin_s is not None]
        least = replace(first, margin_s=min(margins, default=None))
        found.append(least if agreed else BoundFlown(str(formula), None, None, None))
    return tuple(found)


def _judged(formula: Formula, pieces: Sequence[Piece], timing: Timing) -> BoundFlown:
    if timing.laps:
        names = propositions(formula)
        last = [
            k
            for k, (a, b) in enumerate(pairwise(pieces), 1)
            if (a.must & names, a.may & names) != (b.must & names, b.may & names)
        ]
        return BoundFlown(
            str(formula), unbroken(pieces, formula, pieces[last[-1] if last else 0].span[0][0]), None, None
        )
    if not timing.whole:
        return BoundFlown(str(formula), satisfied(so_far(pieces, pieces[-1].span[1][0]), formula), None, None)
    flown = staying(pieces)
    met = satisfied(flown, formula)
    return BoundFlown(str(formula), met, margin_s(flown, formula), settled_s(pieces, formula))


def _since(told: Sequence[Piece], began_s: Fraction) -> list[Piece]:
    """Pieces by the clock of a trajectory; what was before is left out."""
    moved = (
        piece._replace(
            span=((piece.span[0][0] - began_s, piece.span[0][1]), (piece.span[1][0] - began_s, piece.span[1][1]))
        )
        for piece in told
    )
    return [piece for piece in moved if piece.span[1] > (Fraction(0), 0)]


def _pieces(ground: Ground, reaches: Reaches) -> Iterator[Piece]:
    """What is known between each report and the next, both included; alike ones that follow each other are one."""
    over = ground.over(reaches)
    at, plain = over.at, plain_intervals(ground, over)
    letters: list[tuple[tuple[Letter, Letter], int, int]] = []
    for index, is_plain in enumerate(plain.tolist()):
        here = _label(ground, int(at[index]))
        if not is_plain and not reaches.jumps[max(index - 1, 0) : index + 1].any():
            letters.append(((here, here), index, index))  # the report itself
        letters.append(((here, here) if is_plain else _between(ground, over, index), index, index + 1))
    last = _label(ground, int(at[-1]))
    letters.append(((last, last), len(at) - 1, len(at) - 1))
    times = [Fraction(t_s) for t_s in reaches.t_s.tolist()]
    for known, group in groupby(letters, key=lambda each: each[0]):
        parts = list(group)
        yield Piece(from_to(times[parts[0][1]], times[parts[-1][2]], closed=True), *known)


def _between(ground: Ground, over: Over, index: int) -> tuple[Letter, Letter]:
    """What surely held, and what may have, after a report and before the next."""
    numbers = ground.labelling.letter_of
    letters = [ground.labelling.letters[k] for k in np.unique(numbers[over.within(index)]).tolist()]
    if over.leaves(index):
        letters.append(_NOTHING)
    return frozenset.intersection(*letters), frozenset.union(*letters)


def _label(ground: Ground, triangle: int) -> Letter:
    return _NOTHING if triangle == OUTSIDE else ground.labelling.label(triangle)
