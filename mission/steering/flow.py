"""The exact flow of an affine field x' = F x + g in the plane, and the time at which it leaves a triangle.

x(t) = x_0 + t phi(F t) (F x_0 + g) with phi(A) = sum A^n / (n + 1)! (Eq. 10 integrated; no inverse of F, so singular
and defective fields need no special case). By the theorem of Cayley and Hamilton, A^2 = tr(A) A - det(A) I, so every
power series in A is p I + q A with two scalars. They are summed where it is short, at A / 2^k, and doubled k times:
exp(2A) = exp(A)^2, phi(2A) = phi(A) (exp(A) + I) / 2.
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from mission.geometry.arrays import FloatArray

_TERMS = 16  # the last term kept is below 0.5^16 / 17!, far under rounding
_ROUNDING = 1e-14
_SHORT = 0.5  # the norm below which the series is summed


def flow(F: ArrayLike, g: ArrayLike, x0_m: ArrayLike, t_s: ArrayLike) -> FloatArray:
    """Positions at the times ``t_s`` from the start ``x0_m``.

    Args:
        F: Shape (2, 2) or (T, 2, 2), 1/s.
        g: Shape (2,) or (T, 2), m/s.
        x0_m: Shape (2,) or (T, 2), metres.
        t_s: Shape (T,), of either sign.

    Returns:
        Shape (T, 2), metres.
    """
    position, _ = flow_with_velocity(F, g, x0_m, t_s)
    return position


def flow_with_velocity(F: ArrayLike, g: ArrayLike, x0_m: ArrayLike, t_s: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Positions and velocities exp(F t) (F x_0 + g), both of shape (T, 2); arguments as in ``flow``."""
    times = np.atleast_1d(np.asarray(t_s, dtype=np.float64))
    field, start = np.asarray(F, dtype=np.float64), np.asarray(x0_m, dtype=np.float64)
    velocity = (field @ start[..., None])[..., 0] + np.asarray(g, dtype=np.float64)
    bend = (field @ velocity[..., None])[..., 0]
    trace = (field[..., 0, 0] + field[..., 1, 1]) * times
    determinant = (field[..., 0, 0] * field[..., 1, 1] - field[..., 0, 1] * field[..., 1, 0]) * times**2
    norm = np.sqrt((field**2).sum(axis=(-2, -1))) * np.abs(times)
    (p_exp, q_exp), (p_phi, q_phi) = _series(trace, determinant, norm)
    column = (slice(None), None)
    moved = times[column] * (p_phi[column] * velocity + (q_phi * times)[column] * bend)
    return start + moved, p_exp[column] * velocity + (q_exp * times)[column] * bend


Pair = tuple[FloatArray, FloatArray]


def _series(trace: FloatArray, determinant: FloatArray, norm: FloatArray) -> tuple[Pair, Pair]:
    """exp(A) and phi(A) as p I + q A, from the trace, the determinant and a norm of A; all of shape (T,)."""
    largest = float(norm.max(initial=0.0))
    doublings = max(0, int(np.ceil(np.log2(largest / _SHORT)))) if largest > 0.0 else 0
    scale = 0.5**doublings
    tr, det = trace * scale, determinant * scale**2
    p_power, q_power = np.ones_like(tr), np.zeros_like(tr)  # A^0
    p_exp, q_exp = p_power.copy(), q_power.copy()
    p_phi, q_phi = p_power.copy(), q_power.copy()
    for n in range(1, _TERMS + 1):  # powers carry their factor 1 / n!
        p_power, q_power = -det * q_power / n, (p_power + tr * q_power) / n
        p_exp, q_exp = p_exp + p_power, q_exp + q_power
        p_phi, q_phi = p_phi + p_power / (n + 1), q_phi + q_power / (n + 1)
    for _ in range(doublings):
        p_phi, q_phi = _product((p_phi, q_phi), (0.5 * (p_exp + 1.0), 0.5 * q_exp), tr, det)
        p_exp, q_exp = _product((p_exp, q_exp), (p_exp, q_exp), tr, det)
        # from p I + q A to p I + (q / 2) (2 A)
        q_phi, q_exp, tr, det = 0.5 * q_phi, 0.5 * q_exp, 2.0 * tr, 4.0 * det
    return (p_exp, q_exp), (p_phi, q_phi)


def _product(left: Pair, right: Pair, tr: FloatArray, det: FloatArray) -> Pair:
    (a, b), (c, d) = left, right
    return a * c - det * b * d, a * d + b * c + tr * b * d


def settling_time(F: FloatArray, g: FloatArray, x0_m: ArrayLike, radius_m: float) -> float:
    """A time at which the flow of a stable field is ``radius_m`` from its equilibrium; 0 where it starts that near.

    Args:
        F: Shape (2, 2), 1/s, with eigenvalues of negative real part.
        g: Shape (2,), m/s.
        x0_m: Shape (2,).
        radius_m: Positive.

    Raises:
        ValueError: If the field is not stable.
    """
    if np.trace(F) >= 0.0 or np.linalg.det(F) <= 0.0:
        raise ValueError("the field has no stable equilibrium")
    centre = -np.linalg.solve(F, g)

    def beyond(t: float) -> float:
        return float(np.hypot(*(flow(F, g, x0_m, t)[0] - centre))) - radius_m

    if beyond(0.0) <= 0.0:
        return 0.0
    late = -1.0 / float(np.trace(F))
    while beyond(late) > 0.0:
        late *= 2.0
    return float(brentq(beyond, 0.0, late, rtol=1e-12))


def exit_time(
    F: FloatArray, g: FloatArray, corners_m: FloatArray, facet: int, x0_m: ArrayLike
) -> tuple[float, FloatArray]:
    """When and where the flow from ``x0_m`` leaves a triangle through its exit facet.

    Under an exit field the outward rate across the facet is positive everywhere in the triangle, so the distance to it
    falls strictly and has one root, no later than the distance over the slowest rate.

    Args:
        F: Shape (2, 2), 1/s.
        g: Shape (2,), m/s.
        corners_m: Shape (3, 2), counter-clockwise.
        facet: Index j of the vertex opposite the exit facet.
        x0_m: Shape (2,), in the closed triangle.

    Returns:
        The time in seconds, and the point on the facet, shape (2,).

    Raises:
        ValueError: If the field does not lead out through the facet.
    """
    start = np.asarray(x0_m, dtype=np.float64)
    tail, head = corners_m[(facet + 1) % 3], corners_m[(facet + 2) % 3]
    along = head - tail
    length = float(np.hypot(*along))
    normal = np.array([along[1], -along[0]]) / length
    rates = (corners_m @ F.T + g) @ normal
    if rates.min() <= 0.0:
        raise ValueError("the field has points from which it does not lead out through the facet")
    distance = float(normal @ (tail - start))
    if distance <= _ROUNDING * (length + float(np.abs(corners_m).max())):  # the start lies on the facet
        return 0.0, start

    # Counted from a corner of the exit, so that a domain far from its origin costs no digits.
    near, drift = start - tail, g + F @ tail

    def remaining(t: float) -> float:
        return -float(normal @ flow(F, drift, near, t)[0])

    early, late = 0.0, distance / float(rates.min())
    while remaining(late) > 0.0:  # by rounding only
        early, late = late, 1.01 * late
    time = float(brentq(remaining, early, late, xtol=1e-14 * late, rtol=1e-14, maxiter=1000))
    share = float(np.clip(flow(F, drift, near, time)[0] @ along / length**2, 0.0, 1.0))
    return time, tail + share * along
