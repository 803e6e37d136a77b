"""Laws that are known of pieces of a curve already: what is flown as it was before needs no other."""

from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

import numpy as np

from mission.steering.grid import Limits, Slow, grid_of
from mission.steering.joined import Curve, JoinedCurve, Piece
from mission.steering.law import TimeLaw
from mission.steering.strain import strain

_SAME: Final = 1e-9
"""Of the curve's parameter: rounding."""
_CELLS: Final = 64
_NEARLY: Final = 1.01
"""Of a limit: its bounds were proved on other cells; a law that was made for larger limits asks for more than that."""


class KnownLaw(NamedTuple):
    """A piece of a curve, and the law by which it is flown to rest: from rest, or at the begin of a curve in motion."""

    piece: Piece
    law: TimeLaw


def laws_of(curve: Curve, law: TimeLaw) -> tuple[KnownLaw, ...]:
    """The pieces of a curve that are flown from rest to rest by its law, without a rest in between."""
    pieces, joints = _cut(curve)
    found = []
    for piece, begin, end in zip(pieces, joints, joints[1:], strict=False):
        rounding = _SAME * piece.duration_s
        first = int(np.searchsorted(law.knots_s, begin + rounding, side="right")) - 1
        own = slice(first, int(np.searchsorted(law.knots_s, end - rounding)) + 1)
        rates = law.rates[own]
        if len(rates) > 2 and not rates[[0, -1]].any() and bool((rates[1:-1] > 0.0).all()):  # noqa: PLR2004 - inner ones
            times, places = law.knots_t_s[own] - law.knots_t_s[first], law.knots_s[own] - begin
            places[0], places[-1] = 0.0, piece.duration_s
            found.append(KnownLaw(piece, TimeLaw(times, places, rates, law.growths[own])))
    return tuple(found)


def known_law(
    curve: Curve,
    span_s: tuple[float, float],
    known: Iterable[KnownLaw],
    limits: Limits,
    slow: Sequence[Slow],
    *,
    begins: tuple[float, float] = (0.0, 0.0),
) -> TimeLaw | None:
    """The law that is known of a part of a curve, if it keeps the limits; None where there is none.

    Args:
        curve: The curve.
        span_s: Where the part begins, and where it ends at rest.
        known: Laws of pieces.
        limits: Those of the vehicle.
        slow: Where it is to be slow.
        begins: The rate with which the part begins, and the growth there if it is not at rest.
    """
    pieces, joints = _cut(curve)
    piece = next((piece for piece, *ends in zip(pieces, joints, joints[1:], strict=False) if (*ends,) == span_s), None)
    law = next((each.law for each in known if each.piece is piece and _begins(each.law, begins)), None)
    if law is None:
        return None
    knots = law.knots_s
    if begins[0] > 0.0:  # it may have few knots, and must not be slowed down by anyone who checks it
        cuts = [each.begin_s for each in slow if 0.0 < each.begin_s < knots[-1]]
        knots = np.union1d(knots, [*np.linspace(0.0, knots[-1], _CELLS + 1), *cuts])
    excess = strain(law, grid_of(curve, span_s, knots, limits, slow), limits).excess
    return law if excess <= (1.0 if begins[0] > 0.0 else _NEARLY) else None


def _begins(law: TimeLaw, begins: tuple[float, float]) -> bool:
    rate, growth = begins
    return bool(law.rates[0] == rate and (rate == 0.0 or law.growths[0] == growth))


def _cut(curve: Curve) -> tuple[tuple[Piece, ...], list[float]]:
    """The pieces of a curve, and where they join, its ends included."""
    if not isinstance(curve, JoinedCurve):
        return (curve,), [0.0, curve.duration_s]
    joints: list[float] = curve.joints_s.tolist()
    return curve.pieces, joints
