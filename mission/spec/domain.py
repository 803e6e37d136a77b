"""The domain of a mission: its mesh, its labels, and everything that may be wrong with its geometry."""

from collections.abc import Sequence

import numpy as np
import shapely

from mission.decimals import decimal, measure
from mission.errors import Fault, GeometryError, SpecError
from mission.geometry.arrangement import arranged
from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.faces import FacedMesh
from mission.geometry.location import Locator
from mission.geometry.refinement import finest_m, refined
from mission.geometry.regions import Labelling, label_triangles
from mission.geometry.rings import ring_area_m2, ring_edges
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import SLIVER, EdgesInMesh, slivers, triangulate_nodes
from mission.spec.finding import Finding, Path, dotted, listed
from mission.spec.model import (
    BoundaryDomain,
    MissionSpec,
    NodesDomain,
    Point,
    PointShape,
    PolygonShape,
    Region,
    RegionKind,
    TriangleShape,
)
from mission.spec.outlines import Outline, boundary_outline, place, sound_outlines
from mission.spec.scale import pair

Domain = NodesDomain | BoundaryDomain

_WORTH_SAYING = 1e-3  # of a region's area


def build_domain(spec: MissionSpec) -> tuple[Partition, Labelling]:
    """Mesh and labels of a mission.

    For nodes, triangles and the vertices in each have the order that scipy's Delaunay triangulation gives them. Within
    a boundary, outlines may cross and end at it, and those that nearly meet are joined within ``joined_m``; the mesh
    has the vertices that it needs.

    Raises:
        SpecError: With every fault of the geometry (line 0: a value has no lines).
    """
    partition, labelling, findings = examine_domain(spec.domain, spec.regions, spec.start.position_m)
    if partition is None or labelling is None:
        raise SpecError(tuple(Fault(0, 0, dotted(f.path), f.message, f.hint) for f in findings), spec.name)
    return partition, labelling


def restricted_triangles(spec: MissionSpec, labelling: Labelling) -> BoolArray:
    """Mask of the triangles that lie in a restricted region, shape (M,)."""
    names = frozenset(region.name for region in spec.regions if region.kind is RegionKind.RESTRICTED)
    of_letters = np.array([bool(names & letter) for letter in labelling.letters])
    mask: BoolArray = of_letters[labelling.letter_of]
    return mask


def cut_off(spec: MissionSpec) -> tuple[str, ...]:
    """Warnings for the regions of which something lies outside a boundary that cuts them off."""
    domain = spec.domain
    if isinstance(domain, NodesDomain):
        return ()
    fence = shapely.Polygon(domain.boundary_m)
    warnings = []
    for region in spec.regions:
        if isinstance(region.shape, PolygonShape):
            area = shapely.Polygon(region.shape.corners_m)
            share = 1.0 - area.intersection(fence).area / area.area
            if share > _WORTH_SAYING:
                warnings.append(f"regions.{region.name}: {share:.1%} of it lies outside the boundary and is cut off")
    return tuple(warnings)


def examine_domain(
    domain: Domain, regions: Sequence[Region], start_m: Point | None
) -> tuple[Partition | None, Labelling | None, list[Finding]]:
    """Mesh as far as it can be had, labels where nothing is wrong, and everything that is wrong.

    Args:
        domain: Nodes or boundary.
        regions: Those whose shape is known.
        start_m: Where the flight begins; None where that is unknown.
    """
    outlines, findings = sound_outlines(domain, regions)
    if any(finding.path[0] == "domain" for finding in findings):
        return None, None, findings
    try:
        mesh = _meshed(domain, outlines)
    except GeometryError as error:
        return None, None, [*findings, _no_mesh(domain, error)]
    partition = mesh.partition
    if isinstance(domain, NodesDomain):
        findings.extend(_missing_edges(partition, outlines))
    locator = Locator(partition)
    members: dict[str, BoolArray] = {}
    rings = {outline.region: outline.ring_m for outline in outlines}
    for region in regions:
        if not isinstance(region.shape, PolygonShape) or region.name in rings:
            members[region.name], found = _members(region, mesh, locator, rings)
            findings.extend(found)
            if isinstance(domain, BoundaryDomain) and not found and not members[region.name].any():
                findings.append(_vanished(region.name, joined_m(partition.extent_m)))
    findings.extend(_degenerate(partition, _sources(domain, outlines)))
    if start_m is not None:
        restricted = [region.name for region in regions if region.kind is RegionKind.RESTRICTED]
        findings.extend(_start_findings(start_m, locator, {k: v for k, v in members.items() if k in restricted}))
    findings = list(dict.fromkeys(findings))
    return partition, None if findings else label_triangles(partition.size, members), findings


def joined_m(extent_m: float) -> float:
    """What is closer than this is joined in the mesh of a domain of some extent."""
    return min(0.01, 1e-4 * extent_m)


def _meshed(domain: Domain, outlines: list[Outline]) -> FacedMesh:
    """The mesh; over nodes, edges of the outlines may be missing in it."""
    if isinstance(domain, NodesDomain):
        return FacedMesh.of(triangulate_nodes(np.array(domain.nodes_m)))
    rim = ring_edges(boundary_outline(domain).ring_m)
    fence = shapely.Polygon(rim[:, 0])
    # What sticks out is cut off before it is meshed: vertices out there would only make triangles inside smaller.
    within = [_straight_parts(ring_edges(outline.ring_m), fence) for outline in outlines]
    return refined(
        arranged(np.concatenate((rim, *within)), joined_m(float(np.ptp(rim[:, 0], axis=0).max()))),
        fence,
        smallest_angle_deg=domain.refinement.smallest_angle_deg,
        largest_m=domain.refinement.largest_m,
    )


def _straight_parts(edges_m: FloatArray, within: shapely.Polygon) -> FloatArray:
    """The parts of edges, shape (E, 2, 2), that lie within a polygon, shape (P, 2, 2)."""
    parts = shapely.get_parts(shapely.intersection(shapely.linestrings(edges_m), within))
    lines = parts[(shapely.get_type_id(parts) == shapely.GeometryType.LINESTRING) & (shapely.length(parts) > 0.0)]
    ends: FloatArray = shapely.get_coordinates(lines).reshape(-1, 2, 2)
    return ends


def _missing_edges(mesh: Partition, outlines: list[Outline]) -> list[Finding]:
    """What to do about edges that are missing in a mesh of nodes."""
    if not outlines:
        return []
    owners = [(outline, index) for outline in outlines for index in range(len(outline.ring_m))]
    edges = np.concatenate([ring_edges(outline.ring_m) for outline in outlines])
    found = EdgesInMesh.of(mesh, edges)
    gaps = mesh.vertices_m[found.links[~found.present]].mean(axis=1)
    gap_of = found.edge_of[~found.present]
    findings = []
    for edge in found.missing.tolist():
        outline, index = owners[edge]
        a, b = edges[edge]
        message = f"the edge of {outline.region} from {place(a)} to {place(b)} is no edge of the mesh"
        middles = listed(map(pair, gaps[gap_of == edge]), most=4)
        hint = f"other points are too near; add to domain.nodes a point on each gap in the edge, such as {middles}"
        findings.append(Finding((*outline.path, index), message, hint))
    return findings


def _members(
    region: Region, mesh: FacedMesh, locator: Locator, rings: dict[str, FloatArray]
) -> tuple[BoolArray, list[Finding]]:
    """Mask of a region's triangles, shape (M,), and what is wrong with its shape."""
    partition = mesh.partition
    mask = np.zeros(partition.size, dtype=np.bool_)
    if isinstance(region.shape, TriangleShape):
        # Three different nodes, each of them among the three of the triangle: the order does not matter.
        mask = np.ones(partition.size, dtype=np.bool_)
        for node in region.shape.nodes:
            mask &= np.logical_or.reduce(np.equal(partition.triangles.T, node))
        return mask, [] if mask.any() else [_no_such_triangle(region.name, region.shape.nodes, partition)]
    if isinstance(region.shape, PointShape):
        point = region.shape.point_m
        touching = locator.triangles_touching(point)
        mask[touching] = True
        if len(touching) == 1:
            return mask, []
        return mask, [_no_one_triangle(region.name, point, touching.tolist(), partition)]
    return mesh.inside(rings[region.name]), []


def _no_mesh(domain: Domain, error: GeometryError) -> Finding:
    if isinstance(domain, NodesDomain):
        return Finding(("domain", "nodes"), str(error), "three nodes at least must not lie on one line")
    wanted = domain.refinement
    finest = finest_m(abs(ring_area_m2(boundary_outline(domain).ring_m)))
    if wanted.largest_m < finest:
        hint = f"write more than {measure(2.0 * finest)}, or leave it out"
        return Finding(("domain", "mesh", "largest_m"), str(error), hint)
    hint = (
        "let outlines that run very close to each other meet, or write a larger `largest_m` or `smallest_angle_deg: 20`"
    )
    return Finding(("domain", "mesh"), str(error), hint)


def _vanished(name: str, joined: float) -> Finding:
    message = f"nothing is left of {name} in the mesh, in which whatever is closer than {measure(joined)} m is joined"
    return Finding(("regions", name, "polygon"), message, "make it larger, or take it away")


def _no_such_triangle(name: str, nodes: tuple[int, int, int], partition: Partition) -> Finding:
    path = ("regions", name, "triangle")
    last = len(partition.vertices_m) - 1
    unknown = [node for node in nodes if node > last]
    if unknown:
        return Finding(path, f"there is no node {listed(unknown)}", f"the nodes are numbered from 0 to {last}")
    shared = np.isin(partition.triangles.T, nodes).sum(axis=0)
    near = partition.triangles[np.flatnonzero(shared == shared.max())[:6]]
    triples = listed(f"[{a}, {b}, {c}]" for a, b, c in near.tolist())
    message = f"the nodes {nodes[0]}, {nodes[1]} and {nodes[2]} are no triangle of the mesh"
    return Finding(path, message, f"triangles with most of these nodes: {triples}; or name a point inside with `at`")


def _no_one_triangle(name: str, point: Point, touching: list[int], partition: Partition) -> Finding:
    path = ("regions", name, "at")
    if not touching:
        return Finding(path, f"the point {place(point)} of {name} lies outside the domain", _reach(partition))
    message = f"the point {place(point)} of {name} lies on an edge between triangles"
    inside = listed(map(pair, partition.incentres_m[touching[:6]]))
    return Finding(path, message, f"move it inside one of them, such as {inside}")


def _sources(domain: Domain, outlines: list[Outline]) -> list[tuple[Path, FloatArray]]:
    """The lists of the file that the vertices of the mesh come from, in order, with their paths."""
    if isinstance(domain, NodesDomain):
        return [(("domain", "nodes"), np.array(domain.nodes_m))]
    return [(outline.path, outline.ring_m) for outline in (boundary_outline(domain), *outlines)]


def _degenerate(partition: Partition, sources: list[tuple[Path, FloatArray]]) -> list[Finding]:
    owners: list[Path] = [(*path, index) for path, points in sources for index in range(len(points))]
    places = np.concatenate([points for _, points in sources])
    findings = []
    for index in slivers(partition).tolist():
        longest = int(np.argmax(partition.edge_lengths_m[index]))
        # The corner opposite the longest side is the one that lies on it, or one of two that lie together.
        corner = partition.corners_m[index, longest]
        owner = owners[int(np.argmin(np.linalg.norm(places - corner, axis=1)))]
        corners = " ".join(place(corner) for corner in partition.corners_m[index])
        height, side = partition.heights_m[index].min(), partition.edge_lengths_m[index].max()
        message = f"the triangle {corners} is degenerate: {measure(height)} m high on a side of {measure(side)} m"
        hint = f"move this corner or take it away; the height must be {decimal(SLIVER)} of the longest side at least"
        findings.append(Finding(owner, message, hint))
    return findings


def _start_findings(start_m: Point, locator: Locator, restricted: dict[str, BoolArray]) -> list[Finding]:
    path = ("start", "position_m")
    touching = locator.triangles_touching(start_m)
    if not len(touching):
        return [Finding(path, f"the start {place(start_m)} lies outside the domain", _reach(locator.partition))]
    within = [name for name, mask in restricted.items() if mask[touching].any()]
    if not within:
        return []
    how = "in" if len(touching) == 1 else "in or on the edge of"
    message = f"the start {place(start_m)} lies {how} the restricted region {listed(within)}"
    return [Finding(path, message, "move it out of every restricted region")]


def _reach(partition: Partition) -> str:
    left, low, right, high = map(decimal, np.concatenate((partition.vertices_m.min(0), partition.vertices_m.max(0))))
    return f"the domain reaches from {left} to {right} east and from {low} to {high} north"
