"""A noisy signal as it can be seen: a low-passed line over the band between its least and greatest values."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from scipy.signal import lfilter

from mission.geometry.arrays import FloatArray

CONSTANTS_IN_A_PICTURE = 200
SAMPLES_IN_A_CONSTANT = 4
BINS_IN_A_CONSTANT = 8


@dataclass(frozen=True, eq=False)
class Filtered:
    """A signal on even times, NaN where there was no sample within half a time constant; shapes (N,).

    Attributes:
        t_s: The middle of each bin.
        line: First-order low-pass, run forward and back, so that nothing is late.
        low: The least sample within half a time constant.
        high: The greatest.
    """

    t_s: FloatArray
    line: FloatArray
    low: FloatArray
    high: FloatArray


def time_constant(t_s: FloatArray) -> float:
    """How long to average in a picture of these times: a round number, no wider than a stroke or some samples."""
    if len(t_s) < SAMPLES_IN_A_CONSTANT:
        return 1.0
    longest = max((t_s[-1] - t_s[0]) / CONSTANTS_IN_A_PICTURE, SAMPLES_IN_A_CONSTANT * float(np.median(np.diff(t_s))))
    return round_number(longest) if longest > 0.0 else 1.0


def filtered(t_s: FloatArray, values: FloatArray, constant_s: float) -> Filtered:
    """Filter samples at ascending times, shapes (N,); those that are NaN count for nothing."""
    known = np.isfinite(values)
    t_s, values = t_s[known], values[known]
    if not len(t_s):
        nothing = np.zeros(0)
        return Filtered(nothing, nothing, nothing, nothing)
    step_s = constant_s / BINS_IN_A_CONSTANT
    bins = ((t_s - t_s[0]) / step_s).astype(np.int64)
    times = t_s[0] + step_s * (np.arange(bins[-1] + 1) + 0.5)
    counts, sums = np.bincount(bins), np.bincount(bins, weights=values)
    filled = counts > 0
    means = np.interp(times, times[filled], sums[filled] / counts[filled])
    least, greatest = np.full(len(times), np.inf), np.full(len(times), -np.inf)
    np.minimum.at(least, bins, values)
    np.maximum.at(greatest, bins, values)
    window = BINS_IN_A_CONSTANT + 1
    low = minimum_filter1d(least, window, mode="nearest")
    high = maximum_filter1d(greatest, window, mode="nearest")
    line = _low_passed(_low_passed(means)[::-1])[::-1]
    seen = np.isfinite(low)
    return Filtered(times, *(np.where(seen, each, np.nan) for each in (line, low, high)))


def round_number(longest: float) -> float:
    """The largest of 1, 2, 5, 10, ... (and their tenths) that is not greater."""
    power = 10.0 ** np.floor(np.log10(longest))
    return float(power * max(digit for digit in (1, 2, 5) if digit * power <= longest))


def _low_passed(values: FloatArray) -> FloatArray:
    """The exact first-order low-pass of a signal that is constant in each bin, at rest at its first value."""
    kept = float(np.exp(-1.0 / BINS_IN_A_CONSTANT))
    passed, _ = lfilter([1.0 - kept], [1.0, -kept], values, zi=[kept * values[0]])
    return np.asarray(passed, dtype=np.float64)
