"""Automatic smoothing takes as few waves as its proof needs, or says where the last attempt fails."""

import pytest

from mission.errors import NoPlanError
from mission.spec.model import Extension, Semantics
from mission.steering.joined import JoinedCurve
from mission.steering.proved_smoothing import fit_legs, smooth_with_proof
from mission.steering.prover import Prover
from tests.support.curves import PAPER_FORMULA, marked, paper_labelling, paper_partition, paper_path, refuting


def prover(tube_m: float, formula: str = PAPER_FORMULA, restricted: tuple[int, ...] = (6,)) -> Prover:
    return Prover(
        paper_partition(),
        paper_labelling(),
        refutation=refuting(formula, paper_labelling().letters),
        semantics=Semantics.STANDARD,
        restricted=marked(paper_partition(), restricted),
        tube_m=tube_m,
    )


@pytest.mark.parametrize("extension", Extension)
@pytest.mark.parametrize("tube_m", [0.0, 0.1, 0.25])
def test_one_wave_less_is_not_proved(extension: Extension, tube_m: float) -> None:
    proved = smooth_with_proof((paper_path(),), prover(tube_m).certify, extension=extension)
    assert proved.certificate.holds
    assert proved.certificate.frequencies == proved.curve.frequencies
    assert 1 < proved.curve.frequencies <= 28
    fewer = fit_legs((paper_path(),), proved.curve.frequencies - 1, extension)
    assert not prover(tube_m).certify(fewer).holds


def test_a_mission_that_one_wave_meets_gets_one_wave() -> None:
    anything = prover(0.0, "true", ())
    proved = smooth_with_proof((paper_path(),), anything.certify, extension=Extension.EVEN)
    assert proved.curve.frequencies == 1


def test_what_cannot_be_proved_fails_with_the_place() -> None:
    across = prover(0.1, "true", (5,))  # a triangle that the planned run goes through
    pattern = r"up to 64 frequencies.*tube of 0.1 m.*may cross a restricted triangle near \(.*at .* s"
    with pytest.raises(NoPlanError, match=pattern):
        smooth_with_proof((paper_path(),), across.certify, extension=Extension.ODD, most_frequencies=64)


def test_the_caller_may_refuse_a_curve() -> None:
    def coarse(curve: JoinedCurve) -> str:
        return "has too few waves" if curve.frequencies < 37 else ""

    proved = smooth_with_proof((paper_path(),), prover(0.1).certify, extension=Extension.ODD, refuses=coarse)
    assert proved.curve.frequencies == 37
    with pytest.raises(NoPlanError, match="the smoothed path has too few waves"):
        smooth_with_proof(
            (paper_path(),),
            prover(0.1).certify,
            extension=Extension.ODD,
            most_frequencies=30,
            refuses=coarse,
        )
