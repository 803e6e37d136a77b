"""The outlines that a mission file draws, checked before they are meshed: nodes, boundary, polygons of regions."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from scipy.spatial import cKDTree

from mission.decimals import decimal, measure
from mission.geometry.arrays import FloatArray
from mission.geometry.rings import edge_crossings, ring_edges, ring_fault
from mission.geometry.simplices import ROUNDING
from mission.spec.finding import Finding, Path
from mission.spec.model import BoundaryDomain, NodesDomain, Point, PolygonShape, Region
from mission.spec.scale import pair, scale_finding

_NEARNESS: Final = 1e-3
"""A corner within this part of the domain's extent of a node was meant to be that node."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A ring of corners, shape (K, 2), and whose it is; ``region`` is empty for the boundary of the domain."""

    path: Path
    ring_m: FloatArray
    region: str


def boundary_outline(domain: BoundaryDomain) -> Outline:
    """The outline of a boundary domain."""
    return Outline(("domain", "boundary"), np.array(domain.boundary_m), "")


def sound_outlines(
    domain: NodesDomain | BoundaryDomain, regions: Sequence[Region]
) -> tuple[list[Outline], list[Finding]]:
    """The outlines of the regions that can be meshed, and what is wrong with the domain's points and the others."""
    key, corners = ("nodes", domain.nodes_m) if isinstance(domain, NodesDomain) else ("boundary", domain.boundary_m)
    base = np.array(corners)
    too_small = scale_finding(("domain", key), base)
    if too_small:
        return [], [too_small]
    findings = _nodes_findings(domain) if isinstance(domain, NodesDomain) else _boundary_findings(domain)
    if findings:
        return [], findings
    extent_m = float(np.ptp(base, axis=0).max())
    tolerance_m = ROUNDING * extent_m
    tree = cKDTree(base)
    outlines = []
    for region in regions:
        if not isinstance(region.shape, PolygonShape):
            continue
        outline = Outline(("regions", region.name, "polygon"), np.array(region.shape.corners_m), region.name)
        fault = ring_fault(outline.ring_m, tolerance_m)
        if fault:
            message = f"the polygon of {region.name} is not simple: {fault}"
            found = [Finding(outline.path, message, "list its corners in order around it, each once")]
        elif isinstance(domain, NodesDomain):
            found = _strangers(outline, tree, tolerance_m, _NEARNESS * extent_m)
        else:
            found = _outside(outline, base)
        findings.extend(found)
        outlines.extend([] if found else [outline])
    if isinstance(domain, BoundaryDomain):
        return outlines, findings  # they may cross, nearly touch, and stick out
    crossings, crossing = _crossings(outlines, tolerance_m)
    return [outline for outline in outlines if outline.region not in crossing], findings + crossings


def place(point: Point | FloatArray) -> str:
    """A point for people."""
    return f"({decimal(point[0])}, {decimal(point[1])})"


def _nodes_findings(domain: NodesDomain) -> list[Finding]:
    nodes = np.array(domain.nodes_m)
    return [
        Finding(
            ("domain", "nodes", later),
            f"node {later} repeats node {first}, {place(nodes[first])}",
            "take it away, and lower the larger node numbers by one",
        )
        for first, later in _repeated(nodes)
    ]


def _boundary_findings(domain: BoundaryDomain) -> list[Finding]:
    fence = boundary_outline(domain)
    tolerance_m = ROUNDING * float(np.ptp(fence.ring_m, axis=0).max())
    fault = ring_fault(fence.ring_m, tolerance_m)
    if fault:
        message = f"the boundary is no simple polygon: {fault}"
        return [Finding(fence.path, message, "list its corners in order around it, each once")]
    return []


def _repeated(points: FloatArray) -> list[tuple[int, int]]:
    """Pairs of a point and a later one at the same place, each later one once."""
    closeness = ROUNDING * float(np.ptp(points, axis=0).max())
    pairs = cKDTree(points).query_pairs(closeness, output_type="ndarray")
    first_of: dict[int, int] = {}
    for first, later in np.sort(pairs, axis=1).tolist():
        first_of[later] = min(first, first_of.get(later, first))
    return [(first, later) for later, first in sorted(first_of.items())]


def _strangers(outline: Outline, nodes: cKDTree, tolerance_m: float, near_m: float) -> list[Finding]:
    """Corners of a region that are no nodes."""
    distances, nearest = map(np.asarray, nodes.query(outline.ring_m))
    findings = []
    for index in np.flatnonzero(distances > tolerance_m).tolist():
        node = int(nearest[index])
        hint = "add it to domain.nodes (at the end, so that no number changes)"
        if distances[index] <= near_m:
            hint = f"write {pair(nodes.data[node])}, which is node {node}"
        message = f"the corner {place(outline.ring_m[index])} of {outline.region} is not a node"
        findings.append(Finding((*outline.path, index), message, hint))
    return findings


def _outside(outline: Outline, boundary: FloatArray) -> list[Finding]:
    """A region of which nothing lies inside the boundary."""
    fence = shapely.Polygon(boundary)
    if shapely.Polygon(outline.ring_m).intersection(fence).area > 0.0:
        return []
    distances = shapely.distance(fence, shapely.points(outline.ring_m))
    index = int(np.argmin(distances))
    nearest = f"the nearest of its corners, {place(outline.ring_m[index])}, is {measure(distances[index])} m from it"
    message = f"{outline.region} lies wholly outside the boundary: {nearest}"
    return [Finding((*outline.path, index), message, "move its corners inside, or widen domain.boundary")]


def _crossings(outlines: list[Outline], tolerance_m: float) -> tuple[list[Finding], set[str]]:
    """One finding for each pair of outlines whose edges cross; and who they are."""
    if not outlines:
        return [], set()
    owner = np.repeat(np.arange(len(outlines)), [len(outline.ring_m) for outline in outlines])
    edges = np.concatenate([ring_edges(outline.ring_m) for outline in outlines])
    pairs, points = edge_crossings(edges, tolerance_m)
    findings: dict[tuple[int, int], Finding] = {}
    for (i, j), point in zip(pairs.tolist(), points, strict=True):
        a, b = sorted((int(owner[i]), int(owner[j])))
        first, second = outlines[a], outlines[b]
        message = f"an edge of {second.region} crosses an edge of {first.region} at {place(point)}"
        hint = "let the two regions share a corner there, or move one of them"
        findings.setdefault((a, b), Finding(second.path, message, hint))
    return list(findings.values()), {outlines[index].region for pair_of in findings for index in pair_of}
