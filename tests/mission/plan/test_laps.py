"""Each lap of a recurrent flight is proved by itself: none leans on what another one visits."""

from pathlib import Path

import numpy as np

from mission.plan import plan_mission
from mission.plan.flight_plan import prover_of
from mission.spec.loader import load_mission
from mission.steering.smoothing import FourierCurve, fit_fourier

PATROL = Path(__file__).parents[3] / "missions" / "patrol.yaml"


def with_a_shortcut(curve: FourierCurve, at_s: float, toward_m: tuple[float, float]) -> FourierCurve:
    """The curve pulled toward a point around one time, left alone elsewhere."""
    s = np.linspace(0.0, curve.duration_s, 4001)
    pull = np.exp(-(((s - at_s) / 6.0) ** 2))[:, None]
    bent = curve.position(s) + 0.9 * pull * (np.array(toward_m) - curve.position(s))
    rest = bent - curve.base_m - np.multiply.outer(s, curve.slope_m_s)
    n = np.arange(1, 201)
    waves = np.sin(np.multiply.outer(n, s) * np.pi / curve.duration_s)
    amplitudes = 2.0 / len(s) * waves @ rest
    return FourierCurve(curve.extension, curve.duration_s, curve.base_m, curve.slope_m_s, amplitudes)


def test_a_lap_that_skips_a_gate_is_refused_although_the_last_lap_is_whole() -> None:
    plan = plan_mission(load_mission(PATROL))
    prover = prover_of(plan.spec, plan.partition, plan.labelling, plan.compiled_refutation, plan.restricted)
    laps = plan.path.laps_from_s
    assert len(laps) == 2
    whole = fit_fourier(plan.path, 200, plan.curve.extension)
    assert prover.certify(whole, laps).holds
    visits = [s for s in plan.path.segments if "north" in plan.labelling.label(s.triangle) and s.start_s > laps[0]]
    skipping = with_a_shortcut(whole, visits[0].start_s + 0.5 * visits[0].duration_s, (60.0, 66.0))
    assert prover.certify(skipping, laps[-1:]).holds
    assert not prover.certify(skipping, laps).holds
