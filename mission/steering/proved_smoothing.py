"""The smoothing with the fewest frequencies that the proof needs (``smoothing: auto``)."""

from collections.abc import Callable
from dataclasses import dataclass

from mission.errors import NoPlanError
from mission.spec.model import Extension
from mission.steering.certificate import Certificate, Prover
from mission.steering.path import SteeringPath
from mission.steering.smoothing import FourierCurve, fit_fourier

FEWEST_FREQUENCIES = 4
MOST_FREQUENCIES = 1024


@dataclass(frozen=True, eq=False)
class ProvedCurve:
    """A curve with the certificate that holds for it."""

    curve: FourierCurve
    certificate: Certificate


def smooth_with_proof(
    path: SteeringPath,
    prover: Prover,
    *,
    extension: Extension,
    laps_from_s: tuple[float, ...],
    most_frequencies: int = MOST_FREQUENCIES,
    refuses: Callable[[FourierCurve], str] = lambda _: "",
) -> ProvedCurve:
    """Smooth a path with as few frequencies as the certificate needs.

    The number is doubled from 4 until a certificate holds, then halved in between: the last number that failed and the
    first that held are brought together by bisection, to neighbours. More frequencies follow the path more closely, so
    the proof gets easier with them in general, but not always: the number found holds, and one less does not, yet a
    still smaller one might.

    Args:
        path: The planned path.
        prover: Certifies curves of this mission.
        extension: How the path is continued beyond its ends.
        laps_from_s: Where each lap begins; empty where the flight stays at its end.
        most_frequencies: Where to give up; at least 1.
        refuses: What else is wrong with a curve, in plain words after "the smoothed path ..."; empty where nothing is.

    Raises:
        NoPlanError: No certificate holds up to ``most_frequencies``; says what fails with that many, and where.
    """
    failed, count = 0, min(FEWEST_FREQUENCIES, most_frequencies)
    longest = fit_fourier(path, count, extension)
    held: ProvedCurve | None = None
    while held is None:
        if count > longest.frequencies:
            longest = fit_fourier(path, min(most_frequencies, 4 * count), extension)
        held, fault = _tried(longest.truncated(count), prover, laps_from_s, refuses)
        if held is None and count >= most_frequencies:
            raise NoPlanError(
                f"no smoothing with up to {most_frequencies} frequencies is proved to satisfy the mission: "
                f"with {most_frequencies}, {fault}"
            )
        if held is None:
            failed, count = count, min(most_frequencies, 2 * count)
    while held.curve.frequencies - failed > 1:
        middle = (held.curve.frequencies + failed) // 2
        better, _ = _tried(longest.truncated(middle), prover, laps_from_s, refuses)
        if better is None:
            failed = middle
        else:
            held = better
    return held


def _tried(
    curve: FourierCurve, prover: Prover, laps_from_s: tuple[float, ...], refuses: Callable[[FourierCurve], str]
) -> tuple[ProvedCurve | None, str]:
    """The curve with its certificate if all is proved; else what is wrong with it."""
    fault = refuses(curve)
    if fault:
        return None, f"the smoothed path {fault}"
    certificate = prover.certify(curve, laps_from_s)
    if certificate.holds:
        return ProvedCurve(curve, certificate), ""
    return None, f"the tube of {certificate.tube_m:g} m around the smoothed path {certificate.reason}"
