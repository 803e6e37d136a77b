"""The smoothing with the fewest frequencies that the proof needs (``smoothing: auto``)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mission.errors import UnprovedError
from mission.spec.model import Extension
from mission.steering.certificate import Certificate
from mission.steering.joined import Curve, JoinedCurve, Piece
from mission.steering.path import SteeringPath
from mission.steering.rounded import RoundedPolyline
from mission.steering.smoothing import FourierCurve, fit_fourier

FEWEST_FREQUENCIES = 4
MOST_FREQUENCIES = 1024


@dataclass(frozen=True, eq=False)
class ProvedCurve:
    """A curve with the certificate that holds for it."""

    curve: JoinedCurve
    certificate: Certificate


def fit_legs(legs: Sequence[SteeringPath], frequencies: int, extension: Extension) -> JoinedCurve:
    """Smooth each leg of a flight.

    Args:
        legs: The planned path, from rest to rest each.
        frequencies: Number of waves of the longest part that fields steer; the others have their share of it by their
            durations, so that all follow the path equally closely. Lanes stay as they are.
        extension: How such a part is continued beyond its ends. Where there are several it must be odd, or they do not
            join.
    """
    parts = [leg.parts for leg in legs]
    longest_s = max(_steered_s(part) for leg in parts for part in leg)

    def fitted(part: SteeringPath | RoundedPolyline) -> Piece:
        if isinstance(part, RoundedPolyline):
            return part
        return fit_fourier(part, _share(frequencies, part.duration_s / longest_s), extension)

    return JoinedCurve(tuple(_joined(tuple(map(fitted, leg))) for leg in parts))


def smooth_with_proof(
    legs: Sequence[SteeringPath],
    certify: Callable[[JoinedCurve], Certificate],
    *,
    extension: Extension,
    first_frequencies: int = FEWEST_FREQUENCIES,
    most_frequencies: int = MOST_FREQUENCIES,
    refuses: Callable[[JoinedCurve], str] = lambda _: "",
) -> ProvedCurve:
    """Smooth a path with as few frequencies as the certificate needs.

    The number is doubled from the first one until a certificate holds, then halved in between: the last number that
    failed and the first that held are brought together by bisection, to neighbours. More frequencies follow the path
    more closely, so the proof gets easier with them in general, but not always: the number found holds, and one less
    does not, yet a still smaller one might.

    Args:
        legs: The planned path, as in ``fit_legs``.
        certify: Certifies curves of this mission.
        extension: As in ``fit_legs``.
        first_frequencies: What to try first.
        most_frequencies: Where to give up; at least 1.
        refuses: What else is wrong with a curve, in plain words after "the smoothed path ..."; empty where nothing is.

    Raises:
        UnprovedError: No certificate holds up to ``most_frequencies``; says what fails with that many, and where.
    """
    failed, count = 0, min(first_frequencies, most_frequencies)
    fitted, longest = count, fit_legs(legs, count, extension)
    held: ProvedCurve | None = None
    while held is None:
        if count > fitted:
            fitted = min(most_frequencies, 4 * count)
            longest = fit_legs(legs, fitted, extension)
        held, fault, certificate = _tried(_truncated(longest, count), certify, refuses)
        if held is None and count >= most_frequencies:
            raise UnprovedError(
                f"no smoothing with up to {most_frequencies} frequencies is proved to satisfy the mission: "
                f"with {most_frequencies}, {fault}",
                counterexample=certificate.counterexample if certificate else (),
                where_s=certificate.where_s if certificate else None,
            )
        if held is None:
            failed, count = count, min(most_frequencies, 2 * count)
    while held.curve.frequencies - failed > 1:
        middle = (held.curve.frequencies + failed) // 2
        better, *_ = _tried(_truncated(longest, middle), certify, refuses)
        if better is None:
            failed = middle
        else:
            held = better
    return held


def _share(frequencies: int, part: float) -> int:
    return max(min(FEWEST_FREQUENCIES, frequencies), round(frequencies * part))


def _truncated(curve: JoinedCurve, frequencies: int) -> JoinedCurve:
    """The same with fewer waves, each piece with its share; they do not depend on how many more were fitted."""
    longest_s = max(_steered_s(piece) for piece in curve.pieces)

    def cut(leg: Curve) -> Curve:
        if isinstance(leg, JoinedCurve):
            return JoinedCurve(tuple(map(cut, leg.legs)))
        if not isinstance(leg, FourierCurve):
            return leg
        return leg.truncated(_share(frequencies, leg.duration_s / longest_s))

    return JoinedCurve(tuple(map(cut, curve.legs)))


def _steered_s(part: SteeringPath | Piece) -> float:
    """How long a part is steered by fields."""
    return part.duration_s if isinstance(part, SteeringPath | FourierCurve) else 0.0


def _joined(pieces: tuple[Piece, ...]) -> Curve:
    return pieces[0] if len(pieces) == 1 else JoinedCurve(pieces)


def _tried(
    curve: JoinedCurve, certify: Callable[[JoinedCurve], Certificate], refuses: Callable[[JoinedCurve], str]
) -> tuple[ProvedCurve | None, str, Certificate | None]:
    """The curve with its certificate if all is proved; else what is wrong with it, and a certificate that fails."""
    fault = refuses(curve)
    if fault:
        return None, f"the smoothed path {fault}", None
    certificate = certify(curve)
    if certificate.holds:
        return ProvedCurve(curve, certificate), "", None
    reason = f"the tube of {certificate.tube_m:g} m around the smoothed path {certificate.reason}"
    return None, reason, certificate
