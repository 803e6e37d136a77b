"""Whether the fields that steer through triangles do what the paper asks of them, and lead along the path.

A field u = F x + g leaves through facet j, by Eqs. 13 to 15, where at the vertex opposite it leads away from the two
other facets, and at the others out through j and not through the third one; it stays, by Eq. 21, where it leads
inwards at each vertex. Its flow is the exponential of [[F, g], [0, 0]].
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray
from mission.geometry.simplices import Partition

_ROUNDING: Final = 1e-8  # of the extent of the domain, of a speed, of a time

Segments = Sequence[Mapping[str, Any]]


def steering_fault(segments: Segments, partition: Partition, start_m: Sequence[float], speed_m_s: float) -> str | None:
    """What is wrong with the segments of a path; None where nothing is.

    Args:
        segments: Of the plan file.
        partition: The triangles.
        start_m: Where the path begins.
        speed_m_s: Of the fields at the vertices, Eq. 19.
    """
    triangle, control = (np.array([each[key] for each in segments]) for key in ("triangle", "control"))
    F, g, entry = (np.array([each[key] for each in segments], dtype=float) for key in ("F", "g", "entry_m"))
    start, lasts = (np.array([each[key] for each in segments], dtype=float) for key in ("start_s", "duration_s"))
    covers = np.array(["lanes" in each for each in segments])
    straight = (F == 0.0).all(axis=(1, 2)) & (control == 0) & ~covers
    steered = ~covers & ~straight
    after, _ = _flows(F, g, entry, lasts)
    after[covers] = entry[covers]
    size = partition.extent_m
    pace = np.hypot(*g.T)
    faults = {
        "does not begin where the one before it ends": np.abs(np.vstack((start_m, after[:-1])) - entry).max(axis=1)
        > _ROUNDING * size,
        "does not begin when the one before it ends": np.abs(np.append(0.0, (start + lasts)[:-1]) - start)
        > _ROUNDING * (1.0 + start),
        "does not last": lasts <= 0.0,
        "begins or ends outside of its triangle": np.minimum(
            partition.barycentric(triangle, entry).min(axis=1), partition.barycentric(triangle, after).min(axis=1)
        )
        < -_ROUNDING * size / partition.heights_m[triangle].min(axis=1),
        "leads the wrong way at a vertex": steered & (_margins(partition, triangle, control, F, g) <= 0.0),
        "has not the mission's speed at its vertices": steered
        & (_off_speed(partition, triangle, F, g, speed_m_s) > _ROUNDING),
        "is straight, but not at the mission's speed": straight & (np.abs(pace - speed_m_s) > _ROUNDING * speed_m_s),
        "flies lanes, but steers": covers & ((F != 0.0).any(axis=(1, 2)) | (g != 0.0).any(axis=1) | (control != 0)),
        "does not end on its facet": (control > 0)
        & (np.abs(partition.barycentric(triangle, after)[np.arange(len(control)), control - 1]) > _ROUNDING),
    }
    for what, wrong in faults.items():
        if wrong.any():
            return f"`path.segments.{int(np.argmax(wrong))}` {what}"
    return None


def _flows(F: FloatArray, g: FloatArray, entry_m: FloatArray, lasts_s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Where fields (n, 2, 2), (n, 2) lead from places (n, 2) in times (n,), and the integrals of the places."""
    block = np.zeros((len(F), 5, 5))
    block[:, :2, :2], block[:, :2, 2], block[:, 3:, :2] = F, g, np.eye(2)
    state = np.concatenate((entry_m, np.ones((len(F), 1)), np.zeros((len(F), 2))), axis=1)
    after = (_exponential(block * lasts_s[:, None, None]) @ state[..., None])[..., 0]
    return after[:, :2], after[:, 3:]


def _exponential(matrices: FloatArray) -> FloatArray:
    """The exponentials of matrices (n, k, k): Taylor's series of a part that is small, squared again and again."""
    halvings = max(0, int(np.ceil(np.log2(max(1.0, float(np.abs(matrices).sum(axis=2).max()))))) + 1)
    small = matrices / 2.0**halvings
    term = total = np.broadcast_to(np.eye(matrices.shape[1]), matrices.shape)
    for order in range(1, 16):
        term = term @ small / order
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return np.asarray(total)


def _at_vertices(partition: Partition, triangle: IntArray, F: FloatArray, g: FloatArray) -> FloatArray:
    """Velocities at the vertices, shape (n, 3, 2)."""
    return np.asarray(np.einsum("nxy,nvy->nvx", F, partition.corners_m[triangle]) + g[:, None])


def _off_speed(partition: Partition, triangle: IntArray, F: FloatArray, g: FloatArray, speed_m_s: float) -> FloatArray:
    speeds = np.linalg.norm(_at_vertices(partition, triangle, F, g), axis=2)
    return np.asarray(np.abs(speeds / speed_m_s - 1.0).max(axis=1))


def _margins(partition: Partition, triangle: IntArray, control: IntArray, F: FloatArray, g: FloatArray) -> FloatArray:
    """The least of the rates that must be positive, shape (n,), m/s."""
    # rates[n, v, f]: outwards across facet f at vertex v
    rates = np.einsum("nfx,nvx->nvf", partition.normals[triangle], _at_vertices(partition, triangle, F, g))
    vertex, facet = np.indices((3, 3))
    leaving = control[:, None, None] - 1
    # A vertex lies on the two facets that it is not opposite of.
    wanted = np.where(facet == leaving, rates, -rates)
    return np.asarray(np.where(vertex == facet, np.inf, wanted).min(axis=(1, 2)))


def series_fault(curve: Mapping[str, Any], segments: Segments) -> str | None:
    """Whether a curve is not the Fourier series of the path through some segments (Sec. 4.3); None where it is.

    The integral of x(t) exp(i w t) over a segment with x' = F x + g follows from its ends, by parts: it is (F + i w)^-1
    times the difference of x exp(i w t) - g exp(i w t) / (i w) between them.
    """
    F, g, entry = (np.array([each[key] for each in segments], dtype=float) for key in ("F", "g", "entry_m"))
    lasts = np.array([each["duration_s"] for each in segments], dtype=float)
    begins, duration = np.cumsum(lasts) - lasts, float(curve["duration_s"])
    after, sums = _flows(F, g, entry, lasts)
    given = np.array(curve["coefficients_m"], dtype=float)
    base, slope = (np.array(curve[key], dtype=float) for key in ("base_m", "slope_m_s"))
    size = 1.0 + float(np.abs(entry).max())
    waves = np.arange(1, len(given) + 1)
    w = waves[:, None] * np.pi / duration
    turned = np.exp(1j * w * begins), np.exp(1j * w * (begins + lasts))
    ends = [turn[..., None] * (at - g / (1j * w[..., None])) for turn, at in zip(turned, (entry, after), strict=True)]
    rise = ends[1] - ends[0]
    inner = np.linalg.solve(F + 1j * w[..., None, None] * np.eye(2), rise[..., None])[..., 0]
    integrals = inner.sum(axis=1) * (2.0 / duration)
    signs = ((-1.0) ** waves)[:, None]
    if curve["extension"] == "odd":
        due_base, due_slope = entry[0], (after[-1] - entry[0]) / duration
        due = integrals.imag - (2.0 / (np.pi * waves[:, None])) * (
            due_base * (1.0 - signs) - due_slope * duration * signs
        )
    else:
        due_base, due_slope, due = sums.sum(axis=0) / duration, np.zeros(2), integrals.real
    off = max(
        float(np.abs(given - due).max()),
        float(np.abs(base - due_base).max()),
        float(np.abs(slope - due_slope).max()) * duration,
        abs(float(lasts.sum()) - duration),
    )
    return f"is off the series of its path by {off:.3g}" if off > _ROUNDING * size else None
