"""The lists of corners that a mission file has for its areas, and what is wrong with them one by one."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray
from mission.geometry.rings import ring_fault, ring_faults
from mission.spec.finding import Finding, Path
from mission.spec.model import AreaShape, CircleShape, PolygonShape, PolygonsShape, StripShape


class Drawn(StrEnum):
    """What a list of corners draws, by its key in the file."""

    POLYGON = "polygon"
    HOLE = "hole"
    LINE = "line"


@dataclass(frozen=True, eq=False)
class DrawnRing:
    """Corners in a row, shape (K, 2).

    Attributes:
        path: Where they stand.
        corners_m: Closed by itself, but for a line.
        region: Whose they are; empty for the boundary of the domain.
        draws: What they draw.
        around_m: Of a hole, the polygon that it is in.
    """

    path: Path
    corners_m: FloatArray
    region: str
    draws: Drawn = Drawn.POLYGON
    around_m: FloatArray | None = None


def drawn_rings(path: Path, shape: AreaShape, region: str) -> list[DrawnRing]:
    """All lists of corners of a shape; a circle has none."""
    if isinstance(shape, CircleShape):
        return []
    if isinstance(shape, StripShape):
        return [DrawnRing((*path, "line"), np.array(shape.line_m), region, Drawn.LINE)]
    if isinstance(shape, PolygonsShape):
        return [
            ring for i, part in enumerate(shape.parts) for ring in _of_polygon((*path, "polygons", i), part, region)
        ]
    if not region and not shape.holes_m:  # the boundary is a mere list of corners, most often
        return [DrawnRing(path, np.array(shape.corners_m), region)]
    return _of_polygon(path, shape, region)


def extent_points(shape: AreaShape) -> FloatArray:
    """The corners of a shape, or two that a circle reaches to on both axes, shape (N, 2)."""
    if isinstance(shape, CircleShape):
        return np.array(shape.centre_m) + shape.radius_m * np.array([[-1.0, -1.0], [1.0, 1.0]])
    return np.concatenate([ring.corners_m for ring in drawn_rings((), shape, "")])


def ring_findings(rings: Sequence[DrawnRing], tolerance_m: float) -> list[Finding]:
    """What is wrong with lists of corners; points closer than the tolerance are the same."""
    closed = [ring for ring in rings if ring.draws is not Drawn.LINE]
    faults = iter(ring_faults([ring.corners_m for ring in closed], tolerance_m))
    return [
        finding
        for ring in rings
        for finding in (
            _line_findings(ring, tolerance_m)
            if ring.draws is Drawn.LINE
            else _closed_findings(ring, next(faults), tolerance_m)
        )
    ]


def _closed_findings(ring: DrawnRing, fault: str, tolerance_m: float) -> list[Finding]:
    if fault:
        message = f"{_named(ring)} is not simple: {fault}"
        if not ring.region and ring.draws is Drawn.POLYGON:
            message = f"the boundary is no simple polygon: {fault}"
        return [Finding(ring.path, message, "list its corners in order around it, each once")]
    if ring.around_m is not None and ring_fault(ring.around_m, tolerance_m) == "":
        around, hole = shapely.Polygon(ring.around_m), shapely.Polygon(ring.corners_m)
        if shapely.intersection(around, hole).area <= 0.0:
            return [Finding(ring.path, f"{_named(ring)} lies outside its polygon", "move it inside, or take it away")]
        if shapely.covers(hole, around):
            return [Finding(ring.path, f"{_named(ring)} leaves nothing of its polygon", "make it smaller")]
    return []


def _of_polygon(path: Path, shape: PolygonShape, region: str) -> list[DrawnRing]:
    rim = np.array(shape.corners_m)
    return [
        DrawnRing((*path, "polygon"), rim, region),
        *(
            DrawnRing((*path, "holes", i), np.array(hole), region, Drawn.HOLE, rim)
            for i, hole in enumerate(shape.holes_m)
        ),
    ]


def _line_findings(ring: DrawnRing, tolerance_m: float) -> list[Finding]:
    lengths = np.linalg.norm(np.diff(ring.corners_m, axis=0), axis=1)
    return [
        Finding((*ring.path, i + 1), f"corners {i} and {i + 1} of {_named(ring)} are the same point", "take one away")
        for i in np.flatnonzero(lengths <= tolerance_m).tolist()
    ]


def _named(ring: DrawnRing) -> str:
    whose = ring.region or "the boundary"
    if ring.draws is Drawn.HOLE:
        return f"hole {ring.path[-1]} of {whose}"
    return f"the {ring.draws} of {whose}"
