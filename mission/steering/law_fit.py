"""From rates on a grid to a time law: the cubic spline in time that comes nearest to them."""

from typing import Final

import numpy as np
from scipy.linalg import solveh_banded

from mission.geometry.arrays import FloatArray
from mission.steering.law import TimeLaw, law_from_growths

_STIFF_S: Final = 0.5
_TURNS: Final = 3


def law_through(places: FloatArray, rates: FloatArray, growths: FloatArray, begins: float = 0.0) -> TimeLaw | None:
    """A law that is nearly at these places with these rates and growths, from the first to the last of them.

    It is the cubic spline in time for which the squares of what it is off the places and, times ``_STIFF_S`` squared,
    of what it is off the growths are least.

    Args:
        places: Shape (n + 1,), n >= 6.
        rates: Shape (n + 1,), sigma' there.
        growths: Shape (n - 1,), sigma'' at the inner places; it vanishes at the end.
        begins: sigma'' at the begin.

    Returns:
        None where it would run backwards somewhere.
    """
    widths, sums = np.diff(places), rates[1:] + rates[:-1]
    bends = np.concatenate(([begins], growths, [0.0]))
    steps = 2.0 * widths / sums
    for _ in range(_TURNS):
        # With sigma'' linear, a step s takes the time h with s = h (v_0 + v_1) / 2 - h^2 (a_1 - a_0) / 12.
        steps = np.maximum(2.0 * (widths + steps**2 * np.diff(bends) / 12.0) / sums, 0.5 * steps)
    for at_rest, cell in ((rates[0] == 0.0, 0), (rates[-1] == 0.0, -1)):
        if at_rest:  # with an even third derivative
            steps[cell] = 3.0 * widths[cell] / sums[cell]
    # The law's knots are halfway between those of the grid: its third derivative is constant about each of these.
    times = np.concatenate(([0.0], np.cumsum(steps)))
    bends = np.concatenate(([begins], np.diff(rates) / steps, [0.0]))
    halfway = places[:-1] + steps * (3.0 * rates[:-1] + rates[1:]) / 8.0
    places = np.concatenate((places[:1], halfway, places[-1:]))
    times = np.concatenate(([0.0], 0.5 * (times[1:] + times[:-1]), times[-1:]))
    steps = np.diff(times)
    # At knot j the spline and its second derivative are sums over its coefficients j, j + 1 and j + 2.
    count = len(steps)
    h = np.concatenate(([0.0, 0.0], steps, [0.0, 0.0]))
    two, three = h[1:-2] + h[2:-1], h[:-2] + h[1:-1] + h[2:]
    values = np.stack((h[2:-1] ** 2 / (two * three[:-1]), np.zeros(count + 1), h[1:-2] ** 2 / (two * three[1:])))
    values[1] = 1.0 - values[0] - values[2]
    curves = 6.0 / two * np.stack((1.0 / three[:-1], -1.0 / three[:-1] - 1.0 / three[1:], 1.0 / three[1:]))
    ends = (
        places[0]
        + rates[0] / 3.0 * np.cumsum([0.0, three[0], three[1]])
        + np.array([0.0, 0.0, begins * two[0] * three[1] / 6.0]),
        places[-1] - rates[-1] / 3.0 * np.cumsum([0.0, three[-1], three[-2]])[::-1],
    )
    coefficients = np.concatenate((ends[0], np.zeros(count - 3), ends[1]))
    bands, right = np.zeros((3, count + 3)), np.zeros(count + 3)
    for rows, wanted in ((values, places), (_STIFF_S**2 * curves, _STIFF_S**2 * bends)):
        missing = wanted - sum(rows[i] * coefficients[i : i + count + 1] for i in range(3))
        for i in range(3):
            right[i : i + count + 1] += rows[i] * missing
            for j in range(i + 1):
                bands[i - j, j : j + count + 1] += rows[i] * rows[j]
    inner = slice(3, count)
    coefficients[inner] = solveh_banded(bands[:, inner], right[inner], lower=True)
    found = sum(curves[i] * coefficients[i : i + count + 1] for i in range(3))
    found[[0, -1]] = begins, 0.0
    ends_s = float(places[0]), float(places[-1])
    try:
        return law_from_growths(times, found, (float(rates[0]), float(rates[-1])), ends_s)
    except ValueError:
        return None
