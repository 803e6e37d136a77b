"""Control to a facet and control to stay inside, for all triangles at once (paper, Sec. 4.2, Eqs. 13 to 21).

The steering system is x' = u, so the conditions of the paper act on each vertex velocity by itself and each asks it to
lie in a cone. Its cost (Eq. 19) leaves the direction free: every unit direction of the cone, scaled to the reference
speed c, reaches J = 0. Taken here is the bisector of the cone, which keeps the largest angle to every constraint.

With corners v_j, v_k, v_l counter-clockwise and facet j opposite v_j, to leave through facet j:

- at v_j the cone is the triangle's own angle there: the velocity points between v_k and v_l;
- at v_k it lies between the directions v_k - v_j (along the facet shared with v_j) and v_l - v_k (along the exit);
- at v_l likewise, mirrored.

To stay, each vertex velocity points to the incentre, which is the bisector of the angle there. Between the vertices
the velocity is the affine interpolation u = F x + g (Eq. 16).
"""

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.geometry.simplices import Partition


def exit_velocities(partition: Partition, speed_m_s: float) -> FloatArray:
    """Vertex velocities that lead out through each facet.

    Args:
        partition: M triangles.
        speed_m_s: Reference speed c, positive.

    Returns:
        Shape (M, 3, 3, 2): ``[triangle, exit facet, vertex, xy]``, m/s.
    """
    unit = partition.edges_m / partition.edge_lengths_m[..., None]  # facet j, from vertex j+1 to vertex j+2
    out = np.empty((partition.size, 3, 3, 2))
    for j in range(3):
        k, l = (j + 1) % 3, (j + 2) % 3  # noqa: E741 - the text's v_l
        out[:, j, j] = unit[:, l] - unit[:, k]  # v_j->v_k and v_j->v_l
        out[:, j, k] = unit[:, l] + unit[:, j]  # v_j->v_k and v_k->v_l
        out[:, j, l] = -unit[:, k] - unit[:, j]  # v_j->v_l and v_l->v_k
    return _scaled(out, speed_m_s)


def stay_velocities(partition: Partition, speed_m_s: float) -> FloatArray:
    """Vertex velocities that keep the vehicle inside: toward the incentre, shape (M, 3, 2), m/s."""
    return _scaled(partition.incentres_m[:, None, :] - partition.corners_m, speed_m_s)


def _scaled(directions: FloatArray, speed_m_s: float) -> FloatArray:
    scaled: FloatArray = speed_m_s * directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    return scaled


def affine_fields(corners_m: FloatArray, velocities_m_s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Interpolate vertex velocities: solve Eq. 16 for u = F x + g.

    Args:
        corners_m: Shape (..., 3, 2).
        velocities_m_s: Shape (..., 3, 2), broadcastable to the corners.

    Returns:
        F of shape (..., 2, 2) in 1/s and g of shape (..., 2) in m/s.
    """
    corners, velocities = np.broadcast_arrays(corners_m, velocities_m_s)
    sides = np.swapaxes(corners[..., 1:, :] - corners[..., :1, :], -1, -2)
    changes = np.swapaxes(velocities[..., 1:, :] - velocities[..., :1, :], -1, -2)
    F = changes @ np.linalg.inv(sides)
    g = velocities[..., 0, :] - (F @ corners[..., 0, :, None])[..., 0]
    return F, g


def exit_margins(partition: Partition, velocities_m_s: FloatArray) -> FloatArray:
    """The seven conditions of Eqs. 13 to 15 (rows of Eq. 18), as rates in m/s that must not be negative.

    In order: at v_j, away from facets k and l and from both together (strict); at v_k, out through facet j (strict)
    and not through facet l; at v_l, out through facet j (strict) and not through facet k.

    Args:
        partition: M triangles.
        velocities_m_s: Shape (M, 3, 3, 2) as from ``exit_velocities``.

    Returns:
        Shape (M, 3, 7): ``[triangle, exit facet, condition]``.
    """
    # rates[m, j, v, f]: outward rate across facet f at vertex v under the control to facet j
    rates = np.einsum("mfx,mjvx->mjvf", partition.normals, velocities_m_s)
    margins = np.empty((partition.size, 3, 7))
    for j in range(3):
        k, l = (j + 1) % 3, (j + 2) % 3  # noqa: E741 - the text's v_l
        at_j, at_k, at_l = rates[:, j, j], rates[:, j, k], rates[:, j, l]
        margins[:, j] = np.stack(
            (-at_j[:, k], -at_j[:, l], -at_j[:, k] - at_j[:, l], at_k[:, j], -at_k[:, l], at_l[:, j], -at_l[:, k]),
            axis=1,
        )
    return margins


def exit_rates(partition: Partition, velocities_m_s: FloatArray) -> FloatArray:
    """Slowest outward rate across the exit facet anywhere in the triangle, shape (M, 3), m/s.

    The rate is affine, so its minimum is at a vertex. Where it is positive the field has no fixed point inside and the
    distance to the exit facet falls strictly, so every start leaves, through that facet only.
    """
    rates: FloatArray = np.einsum("mjx,mjvx->mjv", partition.normals, velocities_m_s).min(axis=-1)
    return rates


def stay_margins(partition: Partition, velocities_m_s: FloatArray) -> FloatArray:
    """Inward rates of Eq. 21 at each vertex across each facet that holds it, shape (M, 3, 2), m/s; positive: inside."""
    rates = -np.einsum("mfx,mvx->mvf", partition.normals, velocities_m_s)
    return np.stack([rates[:, v, [(v + 1) % 3, (v + 2) % 3]] for v in range(3)], axis=1)


def stay_equilibria(partition: Partition) -> FloatArray:
    """Where the stay field of each triangle vanishes, shape (M, 2), metres; the same for every speed.

    With unit vectors e_j from the vertices to the incentre, the barycentric coordinates solve
    l_0 e_0 + l_1 e_1 + l_2 e_2 = 0, so each is as the sine of the angle between the two other vectors, which is a right
    angle and half the angle alpha_j of the triangle: l_j is as cos(alpha_j / 2), positive, so the point lies inside.

    It is the only equilibrium, and stable: the flow across the boundary is inward, so the divergence tr F is negative,
    and the index of the field, the sign of det F, is one.
    """
    unit = partition.edges_m / partition.edge_lengths_m[..., None]
    # The sum of the two unit vectors from v_j along its sides is 2 cos(alpha_j / 2) long.
    weights = np.linalg.norm(np.roll(unit, -2, axis=1) - np.roll(unit, -1, axis=1), axis=-1)
    shares = weights / weights.sum(axis=1, keepdims=True)
    return np.asarray((shares[..., None] * partition.corners_m).sum(axis=1))
