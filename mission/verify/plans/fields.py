"""The paper's way: whether fields do in their triangles what it asks, and the curve is the series of their path.

A field u = F x + g leaves through facet j, by Eqs. 13 to 15, where at the vertex opposite it leads away from the two
other facets, and at the others out through j and not through the third one; it stays, by Eq. 21, where it leads
inwards at each vertex. Its flow is the exponential of [[F, g], [0, 0]].
"""

from collections.abc import Mapping, Sequence
from itertools import groupby, pairwise
from typing import Any, Final

import numpy as np
from scipy.linalg import expm

from mission.geometry.arrays import FloatArray
from mission.verify.plans.patches import pieces_of
from mission.verify.plans.written import Written

_ROUNDING: Final = 1e-8  # of the extent of the domain, of a speed, of a time

Segments = Sequence[Mapping[str, Any]]


def steering_fault(plan: Written) -> str | None:
    """What is wrong with the segments of the path of a plan; None where nothing is."""
    segments, partition, speed = plan.data["path"]["segments"], plan.partition, plan.spec.flight.speed_m_s
    triangle, control = (np.array([each[key] for each in segments]) for key in ("triangle", "control"))
    F, g, entry, start, lasts = _numbers(segments, "F", "g", "entry_m", "start_s", "duration_s")
    covers = np.array(["lanes" in each for each in segments])
    straight = (F == 0.0).all(axis=(1, 2)) & (control == 0) & ~covers
    steered = ~covers & ~straight
    after, _ = _flows(F, g, entry, lasts)
    after[covers] = entry[covers]
    at_vertices = np.einsum("nxy,nvy->nvx", F, partition.corners_m[triangle]) + g[:, None]
    # Rates outwards across facet f at vertex v, [n, v, f]; a vertex lies on the two facets that it is not opposite of.
    rates = np.einsum("nfx,nvx->nvf", partition.normals[triangle], at_vertices)
    vertex, facet = np.indices((3, 3))
    margins = np.where(vertex == facet, np.inf, np.where(facet == control[:, None, None] - 1, rates, -rates))
    begun, left = partition.barycentric(triangle, entry), partition.barycentric(triangle, after)
    size = partition.extent_m
    faults = {
        "does not begin where the one before it ends": np.abs(
            np.vstack((plan.data["start_m"], after[:-1])) - entry
        ).max(axis=1)
        > _ROUNDING * size,
        "does not begin when the one before it ends": np.abs(np.append(0.0, (start + lasts)[:-1]) - start)
        > _ROUNDING * (1.0 + start),
        "does not last": lasts <= 0.0,
        "begins or ends outside of its triangle": np.minimum(begun, left).min(axis=1)
        < -_ROUNDING * size / partition.heights_m[triangle].min(axis=1),
        "leads the wrong way at a vertex": steered & (margins.min(axis=(1, 2)) <= 0.0),
        "has not the mission's speed at its vertices": steered
        & (np.abs(np.linalg.norm(at_vertices, axis=2) / speed - 1.0).max(axis=1) > _ROUNDING),
        "is straight, but not at the mission's speed": straight & (np.abs(np.hypot(*g.T) / speed - 1.0) > _ROUNDING),
        "flies lanes, but steers": covers & ((F != 0.0).any(axis=(1, 2)) | (g != 0.0).any(axis=1) | (control != 0)),
        "does not end on its facet": (control > 0) & (np.abs(left[np.arange(len(left)), control - 1]) > _ROUNDING),
    }
    return next(
        (f"`path.segments.{int(np.argmax(wrong))}` {what}" for what, wrong in faults.items() if wrong.any()), None
    )


def _numbers(segments: Segments, *keys: str) -> list[FloatArray]:
    return [np.array([each[key] for each in segments], dtype=float) for key in keys]


def _flows(F: FloatArray, g: FloatArray, entry_m: FloatArray, lasts_s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Where fields (n, 2, 2), (n, 2) lead from places (n, 2) in times (n,), and the integrals of the places."""
    block = np.zeros((len(F), 5, 5))
    block[:, :2, :2], block[:, :2, 2], block[:, 3:, :2] = F, g, np.eye(2)
    state = np.concatenate((entry_m, np.ones((len(F), 1)), np.zeros((len(F), 2))), axis=1)
    after = (expm(block * lasts_s[:, None, None]) @ state[..., None])[..., 0]
    return after[:, :2], after[:, 3:]


def curve_fault(plan: Written) -> str | None:
    """Whether a leg is not the series of its path, with its lanes in between; None where all are."""
    path, legs = plan.data["path"], plan.data["trajectory"]["legs"]
    cuts = sorted({0, *(path["lap"] or ()), len(path["segments"])})
    if len(legs) != len(cuts) - 1:
        return f"there are {len(legs)} legs, and the path has {len(cuts) - 1}"
    for number, (leg, cut) in enumerate(zip(legs, pairwise(cuts), strict=True)):
        grouped = groupby(path["segments"][slice(*cut)], key=lambda segment: segment.get("lanes"))
        parts, pieces = [(lanes, list(part)) for lanes, part in grouped], pieces_of(leg["curve"])
        if len(parts) != len(pieces):
            return f"leg {number} has {len(pieces)} pieces, and its path {len(parts)}"
        for piece, (lanes, part) in zip(pieces, parts, strict=True):
            fault = _series_fault(piece, part) if lanes is None else "is not as its lanes" * (lanes != piece)
            if fault:
                return f"leg {number} {fault}"
    return None


def _series_fault(curve: Mapping[str, Any], segments: Segments) -> str | None:
    """Whether a curve is not the Fourier series of the path through some segments (Sec. 4.3); None where it is.

    The integral of x(t) exp(i w t) over a segment with x' = F x + g follows from its ends, by parts: it is (F + i w)^-1
    times the difference of x exp(i w t) - g exp(i w t) / (i w) between them.
    """
    F, g, entry, lasts = _numbers(segments, "F", "g", "entry_m", "duration_s")
    begins, duration = np.cumsum(lasts) - lasts, float(curve["duration_s"])
    after, sums = _flows(F, g, entry, lasts)
    given, base, slope = (np.array(curve[key], dtype=float) for key in ("coefficients_m", "base_m", "slope_m_s"))
    waves = np.arange(1, len(given) + 1)
    w, signs = waves[:, None] * np.pi / duration, ((-1.0) ** waves)[:, None]
    before, beyond = (
        np.exp(1j * w * t)[..., None] * (at - g / (1j * w[..., None]))
        for t, at in ((begins, entry), (begins + lasts, after))
    )
    inner = np.linalg.solve(F + 1j * w[..., None, None] * np.eye(2), (beyond - before)[..., None])[..., 0]
    due = inner.sum(axis=1) * (2.0 / duration)
    if curve["extension"] == "odd":
        due_base, due_slope = entry[0], (after[-1] - entry[0]) / duration
        line = due_base * (1.0 - signs) - due_slope * duration * signs
        due_given = due.imag - line * (2.0 / (np.pi * waves[:, None]))
    else:
        due_base, due_slope, due_given = sums.sum(axis=0) / duration, np.zeros(2), due.real
    differences = given - due_given, base - due_base, (slope - due_slope) * duration, lasts.sum() - duration
    off = max(float(np.abs(each).max()) for each in differences)
    return f"is off the series of its path by {off:.3g}" if off > _ROUNDING * (1.0 + np.abs(entry).max()) else None
