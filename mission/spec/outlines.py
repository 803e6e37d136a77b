"""The outlines that a mission file draws, checked before they are meshed: nodes, boundary, areas of regions."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import shapely
from scipy.spatial import cKDTree

from mission.decimals import decimal, measure
from mission.geometry.arrays import FloatArray
from mission.geometry.rings import edge_crossings, ring_edges
from mission.geometry.shapes import Area, shrunk
from mission.geometry.simplices import ROUNDING
from mission.spec.areas import Ground, area_ground, boundary_ground, clearance_of
from mission.spec.clearances import BOUNDARY_CLEARANCE, largest_m
from mission.spec.drawn_rings import DrawnRing, drawn_rings, extent_points, ring_findings
from mission.spec.finding import Finding, Path
from mission.spec.model import (
    AreaShape,
    BoundaryDomain,
    CircleShape,
    NodesDomain,
    Point,
    PointShape,
    Region,
    StripShape,
    TriangleShape,
)
from mission.spec.scale import pair, scale_finding

BOUNDARY: Final[Path] = ("domain", "boundary")

_NEARNESS: Final = 1e-3
"""A corner within this part of the domain's extent of a node was meant to be that node."""


@dataclass(frozen=True, eq=False)
class Outlines:
    """What can be meshed of what a file draws.

    Attributes:
        fence: Where the vehicle may fly; None where nodes say that, or where it has faults.
        grounds: The areas of the regions that have one, by name.
        rings: The lists of corners in the file that they come from, those of the boundary first.
    """

    fence: Ground | None = None
    grounds: dict[str, Ground] = field(default_factory=dict)
    rings: tuple[DrawnRing, ...] = ()

    @property
    def extent_m(self) -> float:
        """The longer side of the box around the boundary as it is drawn."""
        return 0.0 if self.fence is None else extent_of(self.fence.drawn)


def sound_outlines(domain: NodesDomain | BoundaryDomain, regions: Sequence[Region]) -> tuple[Outlines, list[Finding]]:
    """The outlines that can be meshed, and what is wrong with the domain's points and the others."""
    drawn = [(region, region.shape) for region in regions if not isinstance(region.shape, TriangleShape | PointShape)]
    bare = [region for region in regions if isinstance(region.shape, TriangleShape | PointShape)]
    outlines, findings = _over_nodes(domain, drawn) if isinstance(domain, NodesDomain) else _within(domain, drawn)
    return outlines, [*findings, *(_no_outline(region) for region in bare if clearance_of(region, domain) > 0.0)]


def extent_of(area: Area) -> float:
    """The longer side of the box around an area."""
    west, south, east, north = area.bounds
    return float(max(east - west, north - south))


def place(point: Point | FloatArray) -> str:
    """A point for people."""
    return f"({decimal(point[0])}, {decimal(point[1])})"


def _within(domain: BoundaryDomain, regions: Sequence[tuple[Region, AreaShape]]) -> tuple[Outlines, list[Finding]]:
    """Within a boundary, outlines may cross, nearly touch and stick out."""
    bounds = drawn_rings(BOUNDARY, domain.boundary, "")
    corners = extent_points(domain.boundary)
    too_small = scale_finding(BOUNDARY, corners)
    if too_small:
        return Outlines(), [too_small]
    tolerance_m = ROUNDING * float(np.ptp(corners, axis=0).max())
    findings = ring_findings(bounds, tolerance_m)
    if findings:
        return Outlines(), findings
    fence = boundary_ground(domain)
    if fence.kept.is_empty:
        return Outlines(), [_nothing_left(fence)]
    grounds, rings = {}, bounds
    for region, shape in regions:
        own = drawn_rings(("regions", region.name), shape, region.name)
        found = ring_findings(own, tolerance_m)
        if not found:
            ground = area_ground(region, shape, domain)
            found = _outside(region.name, ground, own, fence.drawn)
        if not found:
            grounds[region.name] = ground
            rings.extend(own)
        findings.extend(found)
    return Outlines(fence, grounds, tuple(rings)), findings


def _over_nodes(domain: NodesDomain, regions: Sequence[tuple[Region, AreaShape]]) -> tuple[Outlines, list[Finding]]:
    """Over nodes, all corners are nodes, and no outline crosses another."""
    nodes = np.array(domain.nodes_m)
    too_small = scale_finding(("domain", "nodes"), nodes)
    findings = [too_small] if too_small else _nodes_findings(nodes)
    if findings:
        return Outlines(), findings
    extent_m = float(np.ptp(nodes, axis=0).max())
    tolerance_m = ROUNDING * extent_m
    tree = cKDTree(nodes)
    grounds, rings = {}, []
    for region, shape in regions:
        own = drawn_rings(("regions", region.name), shape, region.name)
        found = _needs_boundary(region)
        if not found:
            found = ring_findings(own, tolerance_m)
        if not found:
            strange = (_strangers(ring, tree, tolerance_m, _NEARNESS * extent_m) for ring in own)
            found = [finding for of in strange for finding in of]
        if not found:
            grounds[region.name] = area_ground(region, shape, domain)
            rings.extend(own)
        findings.extend(found)
    crossings, crossing = _crossings(rings, tolerance_m)
    grounds = {name: ground for name, ground in grounds.items() if name not in crossing}
    return Outlines(None, grounds, tuple(ring for ring in rings if ring.region in grounds)), findings + crossings


def _nothing_left(fence: Ground) -> Finding:
    """Of a boundary that its clearance takes away."""
    most = largest_m(lambda clearance_m: not shrunk(fence.drawn, clearance_m).is_empty, fence.clearance_m)
    message = f"nothing is left within the boundary with a clearance of {decimal(fence.clearance_m)} m"
    return Finding(BOUNDARY_CLEARANCE, message, f"write at most {decimal(most or 0.0)}")


def _outside(name: str, ground: Ground, rings: Sequence[DrawnRing], fence: Area) -> list[Finding]:
    """A region of which nothing lies inside the boundary, nor what must be kept clear around it."""
    if any(shapely.intersection(area, fence).area > 0.0 for area in (ground.drawn, ground.kept)):
        return []
    hint = "move it inside, or widen domain.boundary"
    if not rings:
        message = f"{name} lies wholly outside the boundary: {measure(shapely.distance(ground.drawn, fence))} m from it"
        return [Finding(("regions", name, "centre"), message, hint)]
    corners = np.concatenate([ring.corners_m for ring in rings])
    paths = [(*ring.path, index) for ring in rings for index in range(len(ring.corners_m))]
    distances = shapely.distance(fence, shapely.points(corners))
    index = int(np.argmin(distances))
    nearest = f"the nearest of its corners, {place(corners[index])}, is {measure(distances[index])} m from it"
    message = f"{name} lies wholly outside the boundary: {nearest}"
    return [Finding(paths[index], message, "move its corners inside, or widen domain.boundary")]


def _no_outline(region: Region) -> Finding:
    """Of a clearance around a triangle of the mesh, which is where the mesh happens to have it."""
    message = f"{region.name} is one triangle of the mesh, which has no clearance"
    hint = "draw it as a polygon, a circle or a strip, or give it `clearance_m: 0`"
    return Finding(("regions", region.name), message, hint, at_key=True)


def _needs_boundary(region: Region) -> list[Finding]:
    """What a region over nodes cannot be."""
    hint = "give a `boundary` in `domain` instead of `nodes`, or draw a polygon whose corners are nodes"
    path: Path = ("regions", region.name)
    key = {CircleShape: "centre", StripShape: "line"}.get(type(region.shape))
    if key:
        return [Finding((*path, key), f"a circle or a strip, as {region.name} is, needs a boundary", hint, at_key=True)]
    if region.clearance_m:
        message = f"the clearance of {region.name} needs a boundary: over nodes, outlines are where the nodes are"
        return [Finding((*path, "clearance_m"), message, hint, at_key=True)]
    return []


def _nodes_findings(nodes: FloatArray) -> list[Finding]:
    return [
        Finding(
            ("domain", "nodes", later),
            f"node {later} repeats node {first}, {place(nodes[first])}",
            "take it away, and lower the larger node numbers by one",
        )
        for first, later in _repeated(nodes)
    ]


def _repeated(points: FloatArray) -> list[tuple[int, int]]:
    """Pairs of a point and a later one at the same place, each later one once."""
    closeness = ROUNDING * float(np.ptp(points, axis=0).max())
    pairs = cKDTree(points).query_pairs(closeness, output_type="ndarray")
    first_of: dict[int, int] = {}
    for first, later in np.sort(pairs, axis=1).tolist():
        first_of[later] = min(first, first_of.get(later, first))
    return [(first, later) for later, first in sorted(first_of.items())]


def _strangers(ring: DrawnRing, nodes: cKDTree, tolerance_m: float, near_m: float) -> list[Finding]:
    """Corners of a region that are no nodes."""
    distances, nearest = map(np.asarray, nodes.query(ring.corners_m))
    findings = []
    for index in np.flatnonzero(distances > tolerance_m).tolist():
        node = int(nearest[index])
        hint = "add it to domain.nodes (at the end, so that no number changes)"
        if distances[index] <= near_m:
            hint = f"write {pair(nodes.data[node])}, which is node {node}"
        message = f"the corner {place(ring.corners_m[index])} of {ring.region} is not a node"
        findings.append(Finding((*ring.path, index), message, hint))
    return findings


def _crossings(rings: Sequence[DrawnRing], tolerance_m: float) -> tuple[list[Finding], set[str]]:
    """One finding for each pair of outlines whose edges cross; and the regions that they are of."""
    if not rings:
        return [], set()
    owner = np.repeat(np.arange(len(rings)), [len(ring.corners_m) for ring in rings])
    pairs, points = edge_crossings(np.concatenate([ring_edges(ring.corners_m) for ring in rings]), tolerance_m)
    findings: dict[tuple[int, int], Finding] = {}
    for (i, j), point in zip(pairs.tolist(), points, strict=True):
        a, b = sorted((int(owner[i]), int(owner[j])))
        first, second = rings[a], rings[b]
        message = f"an edge of {second.region} crosses an edge of {first.region} at {place(point)}"
        hint = "let the two regions share a corner there, or move one of them"
        findings.setdefault((a, b), Finding(second.path, message, hint))
    return list(findings.values()), {rings[index].region for pair_of in findings for index in pair_of}
