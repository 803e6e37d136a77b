"""The smoothing with the fewest frequencies that the proof needs (``smoothing: auto``)."""

from dataclasses import dataclass

from mission.errors import NoPlanError
from mission.spec.model import Extension
from mission.steering.certificate import Certificate, Prover
from mission.steering.path import SteeringPath
from mission.steering.smoothing import FourierCurve, fit_fourier

FEWEST_FREQUENCIES = 4
MOST_FREQUENCIES = 2048


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
    loop_from_s: float | None,
    most_frequencies: int = MOST_FREQUENCIES,
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
        loop_from_s: Where the last lap begins; None where the flight stays at its end.
        most_frequencies: Where to give up; at least 1.

    Raises:
        NoPlanError: No certificate holds up to ``most_frequencies``; says what fails with that many, and where.
    """
    failed, count = 0, min(FEWEST_FREQUENCIES, most_frequencies)
    longest = fit_fourier(path, count, extension)
    held: ProvedCurve | None = None
    while held is None:
        if count > longest.frequencies:
            longest = fit_fourier(path, min(most_frequencies, 4 * count), extension)
        curve = longest.truncated(count)
        certificate = prover.certify(curve, loop_from_s)
        if certificate.holds:
            held = ProvedCurve(curve, certificate)
        elif count >= most_frequencies:
            raise NoPlanError(
                f"no smoothing with up to {most_frequencies} frequencies is proved to satisfy the mission: with "
                f"{most_frequencies}, the tube of {certificate.tube_m:g} m around it {certificate.reason}"
            )
        else:
            failed, count = count, min(most_frequencies, 2 * count)
    while held.curve.frequencies - failed > 1:
        curve = longest.truncated((held.curve.frequencies + failed) // 2)
        certificate = prover.certify(curve, loop_from_s)
        if certificate.holds:
            held = ProvedCurve(curve, certificate)
        else:
            failed = curve.frequencies
    return held
