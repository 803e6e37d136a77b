"""Whether the lanes of a plan cover what they are said to cover."""

from collections.abc import Iterator, Mapping
from math import comb, isclose, radians, tan
from typing import Any, Final

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray
from mission.spec.model import Camera, Cover, MissionSpec
from mission.verify.plans.patches import DEGREE, Patches

_SHARE: Final = 2e-3
_BESIDE: Final = 1.0 / 8.0 + 1.0 / 30.0  # of a spacing: rounded ends are cut off, small steps aside left out
_SAME: Final = 1e-9


def cover_faults(
    spec: MissionSpec, visit: Mapping[str, Any], area: shapely.Geometry, patches: Patches
) -> Iterator[str]:
    """What is wrong with a visit that covers a region.

    Args:
        spec: The mission.
        visit: Of the plan file.
        area: What of the region may be entered.
        patches: The curve.
    """
    cover = next((region.cover for region in spec.regions if region.name == visit["region"]), None)
    if cover is None:
        yield "is not to be covered"
        return
    spacing, trigger = _distances(cover, spec.flight.altitude_m)
    if not (isclose(spacing, visit["spacing_m"], rel_tol=_SAME) and _alike(trigger, visit["trigger_m"])):
        yield f"asks for lanes {spacing:g} m apart, and pictures every {trigger or 0.0:g} m"
    if visit["share"] != cover.share:
        yield f"asks for a share of {cover.share:g}"
    lanes = np.array(visit["lanes_m"], dtype=float).reshape(-1, 2, 2)
    times = np.array(visit["lanes_s"], dtype=float).reshape(-1, 2)
    order = np.append(visit["start_s"], times.ravel())
    end_s = float(patches.ends_s[-1])
    if len(times) != len(lanes) or (np.diff(order) < -_SAME * end_s).any() or order[-1] > end_s * (1.0 + _SAME):
        yield "has lanes that are not in order"
        return
    times = np.minimum(np.maximum.accumulate(times.ravel()), end_s).reshape(-1, 2)
    beside = np.linalg.norm(patches.at(times.ravel()).reshape(-1, 2, 2) - lanes, axis=2).max(axis=1)
    if beside.max() > _BESIDE * spacing:
        yield f"has a lane, {int(np.argmax(beside))}, that is flown {beside.max():.3f} m beside itself"
    share = 1.0 - area.difference(shapely.union_all(_swaths(patches, times, spacing))).area / area.area
    if abs(share - visit["planned_share"]) > _SHARE:
        yield f"is covered to {share:.2%}, and not to {visit['planned_share']:.2%}"


def _swaths(patches: Patches, times: FloatArray, spacing: float) -> list[shapely.Geometry]:
    """What is within half a spacing of each lane."""
    inside = patches.cut(times.ravel())
    # Of a lane that is too short to be more than a moment of the flight, its place counts.
    found = [*shapely.buffer(shapely.points(patches.at(times[:, 0])), spacing / 2.0, quad_segs=32)]
    for begin, end in times.tolist():
        own = inside.taken((inside.begins_s >= begin) & (inside.ends_s <= end))
        line = _BERNSTEIN @ own.control_m
        found.append(shapely.linestrings(line.reshape(-1, 2)).buffer(spacing / 2.0, quad_segs=32))
    return found


def _table(points: int) -> FloatArray:
    """Values of the Bernstein polynomials at some points."""
    u = np.linspace(0.0, 1.0, points)[:, None]
    powers = np.arange(DEGREE + 1)
    return np.array([comb(DEGREE, i) for i in powers]) * u**powers * (1.0 - u) ** (DEGREE - powers)


_BERNSTEIN: Final = _table(5)


def _distances(cover: Cover, altitude_m: float) -> tuple[float, float | None]:
    """Distance of lanes, and of pictures where some are taken, that a region asks for."""
    if cover.camera is None:
        return cover.spacing_m or 0.0, None
    width, height = _seen(cover.camera)
    return width * altitude_m * (1.0 - cover.camera.sidelap), height * altitude_m * (1.0 - cover.camera.overlap)


def _seen(camera: Camera) -> tuple[float, float]:
    """Width and height of a picture at a distance of one."""
    if camera.field_of_view_deg is not None:
        across, along = (2.0 * tan(radians(angle) / 2.0) for angle in camera.field_of_view_deg)
        return across, along
    width, height = camera.sensor_mm or (0.0, 0.0)
    return width / (camera.focal_length_mm or 1.0), height / (camera.focal_length_mm or 1.0)


def _alike(due: float | None, value: Any) -> bool:  # noqa: ANN401 - of a file
    return value is None if due is None else value is not None and isclose(due, value, rel_tol=_SAME)
