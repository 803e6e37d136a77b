"""Laws from their second derivatives."""

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.steering.law import law_from_growths


def long_law(off: float) -> tuple[FloatArray, FloatArray, float]:
    """Knots and growths of three hours at a rate of one, with one growth that is off, and where it ends without that.

    It is off in a step of half a millisecond, in which a spline through places far from 0 loses that many digits.
    """
    times = np.unique(
        np.concatenate((np.linspace(0.0, 10_800.0, 12_001), [1.0, 1.0005, 1.001, 2.0, 10_798.0, 10_799.0]))
    )
    growths = np.interp(times, [0.0, 1.0, 2.0, 10_798.0, 10_799.0, 10_800.0], [0.0, 1.0, 0.0, 0.0, -1.0, 0.0])
    growths[times == 1.0005] += off
    return times, growths, 10_798.0


def test_what_rounding_leaves_of_a_long_law_is_at_no_single_knot() -> None:
    times, growths, end_s = long_law(2e-5)
    law = law_from_growths(times, growths, (0.0, 0.0), (0.0, end_s))
    steps = np.diff(law.knots_t_s)
    led = law.rates[:-1] + 0.5 * steps * (law.growths[1:] + law.growths[:-1])
    moved = steps * (law.rates[:-1] + steps * (2.0 * law.growths[:-1] + law.growths[1:]) / 6.0)
    assert np.abs(led - law.rates[1:]).max() < 1e-12
    assert np.abs(law.knots_s[:-1] + moved - law.knots_s[1:]).max() < 1e-10 * end_s
    assert np.abs(law.growths - growths).max() < 1e-10
    assert (law.rates >= 0.0).all()
    assert law.growths[[0, -1]].tolist() == [0.0, 0.0]
