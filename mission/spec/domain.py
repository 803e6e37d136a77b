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
from mission.geometry.simplices import ROUNDING, Partition
from mission.geometry.triangulation import (
    SLIVER,
    EdgesInMesh,
    inside_of,
    mesh_of_boundary,
    slivers,
    triangulate_nodes,
)
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
from mission.spec.near_misses import NearMisses, Outline, Pair
from mission.spec.outlines import boundary_outline, place, sound_outlines
from mission.spec.scale import pair

Domain = NodesDomain | BoundaryDomain

_REFINE = "write `mesh: {}` in `domain` instead of points, or "
_WORTH_SAYING = 1e-3  # of a region's area


def build_domain(spec: MissionSpec) -> tuple[Partition, Labelling]:
    """Mesh and labels of a mission.

    For nodes, triangles and the vertices in each have the order that scipy's Delaunay triangulation gives them. For
    a boundary, the vertices are its corners, the points, then the corners of the polygons, each place once; with
    ``refinement``, outlines that nearly meet are joined within ``joined_m``, may cross, and end at the boundary.

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
    if isinstance(domain, NodesDomain) or not domain.refinement:
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
    misses = _near_misses(domain, outlines)
    try:
        mesh, found = _meshed(domain, outlines, misses)
    except GeometryError as error:
        return None, None, [*findings, _no_mesh(domain, error)]
    findings.extend(found)
    if mesh is None:
        return None, None, findings
    partition = mesh.partition
    locator = Locator(partition)
    members: dict[str, BoolArray] = {}
    rings = {outline.region: outline.ring_m for outline in outlines}
    joins = isinstance(domain, BoundaryDomain) and domain.refinement
    for region in regions:
        if not isinstance(region.shape, PolygonShape) or region.name in rings:
            members[region.name], found = _members(region, mesh, locator, rings)
            findings.extend(found)
            if joins and not found and not members[region.name].any():
                findings.append(_vanished(region.name, joined_m(partition.extent_m)))
    findings.extend(_degenerate(partition, _sources(domain, outlines), misses))
    if start_m is not None:
        restricted = [region.name for region in regions if region.kind is RegionKind.RESTRICTED]
        findings.extend(_start_findings(start_m, locator, {k: v for k, v in members.items() if k in restricted}))
    findings = list(dict.fromkeys(findings))
    return partition, None if findings else label_triangles(partition.size, members), findings


def joined_m(extent_m: float) -> float:
    """What is closer than this is joined in the mesh of a domain of some extent."""
    return min(0.01, 1e-4 * extent_m)


def _near_misses(domain: Domain, outlines: list[Outline]) -> NearMisses:
    """Between outlines whose corners can be moved: those over nodes are where the nodes are."""
    movable = [] if isinstance(domain, NodesDomain) else [boundary_outline(domain), *outlines]
    extent_m = float(np.ptp(movable[0].ring_m, axis=0).max()) if movable else 0.0
    return NearMisses(movable, extent_m, ROUNDING * extent_m)


def _meshed(domain: Domain, outlines: list[Outline], misses: NearMisses) -> tuple[FacedMesh | None, list[Finding]]:
    """The mesh, None where the boundary does not come out; and the edges that do not."""
    if isinstance(domain, NodesDomain):
        partition = triangulate_nodes(np.array(domain.nodes_m))
        return FacedMesh.of(partition), _missing_edges(partition, outlines, "domain.nodes", misses)[0]
    fence = boundary_outline(domain)
    if domain.refinement:
        edges = np.concatenate([ring_edges(outline.ring_m) for outline in (fence, *outlines)])
        arrangement = arranged(edges, joined_m(float(np.ptp(fence.ring_m, axis=0).max())))
        wanted = domain.refinement
        return refined(
            arrangement,
            shapely.Polygon(fence.ring_m),
            smallest_angle_deg=wanted.smallest_angle_deg,
            largest_m=wanted.largest_m,
        ), []
    points = np.array(domain.points_m).reshape(-1, 2)
    mesh = mesh_of_boundary(fence.ring_m, points, [outline.ring_m for outline in outlines])
    findings, owners = _missing_edges(mesh, [fence, *outlines], "domain.points", misses)
    if 0 in owners:
        return None, findings
    return FacedMesh.of(inside_of(mesh, fence.ring_m)), findings


def _missing_edges(
    mesh: Partition, outlines: list[Outline], section: str, misses: NearMisses
) -> tuple[list[Finding], set[int]]:
    """What to do about edges that are missing in the mesh, and the outlines that they are of."""
    if not outlines:
        return [], set()
    owners = [(number, index) for number, outline in enumerate(outlines) for index in range(len(outline.ring_m))]
    edges = np.concatenate([ring_edges(outline.ring_m) for outline in outlines])
    found = EdgesInMesh.of(mesh, edges)
    gaps = mesh.vertices_m[found.links[~found.present]].mean(axis=1)
    gap_of = found.edge_of[~found.present]
    findings = []
    nearly: set[Pair] = set()
    for edge in found.missing.tolist():
        number, index = owners[edge]
        outline = outlines[number]
        a, b = edges[edge]
        beside = {of for of in misses.beside(a, b) if number in of}
        if beside:
            nearly |= beside
            continue
        message = f"the edge of {outline.name} from {place(a)} to {place(b)} is no edge of the mesh"
        middles = listed(map(pair, gaps[gap_of == edge]), most=4)
        refine = _REFINE if section == "domain.points" else ""
        hint = f"other points are too near; {refine}add to {section} a point on each gap in the edge, such as {middles}"
        findings.append(Finding((*outline.path, index), message, hint))
    return [*findings, *misses.findings(nearly)], {owners[edge][0] for edge in found.missing.tolist()}


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
    if not wanted:
        return Finding(("domain", "boundary"), str(error), "outlines must not run very close to each other")
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
    fence, points = boundary_outline(domain), np.array(domain.points_m).reshape(-1, 2)
    rings: list[tuple[Path, FloatArray]] = [(outline.path, outline.ring_m) for outline in outlines]
    return [(fence.path, fence.ring_m), (("domain", "points"), points), *rings]


def _degenerate(partition: Partition, sources: list[tuple[Path, FloatArray]], misses: NearMisses) -> list[Finding]:
    owners: list[Path] = [(*path, index) for path, points in sources for index in range(len(points))]
    places = np.concatenate([points for _, points in sources])
    findings = []
    nearly: set[Pair] = set()
    for index in slivers(partition).tolist():
        longest = int(np.argmax(partition.edge_lengths_m[index]))
        beside = misses.beside(*np.delete(partition.corners_m[index], longest, axis=0))
        if beside:
            nearly |= beside
            continue
        # The corner opposite the longest side is the one that lies on it, or one of two that lie together.
        corner = partition.corners_m[index, longest]
        owner = owners[int(np.argmin(np.linalg.norm(places - corner, axis=1)))]
        corners = " ".join(place(corner) for corner in partition.corners_m[index])
        height, side = partition.heights_m[index].min(), partition.edge_lengths_m[index].max()
        message = f"the triangle {corners} is degenerate: {measure(height)} m high on a side of {measure(side)} m"
        hint = f"move this corner or take it away; the height must be {decimal(SLIVER)} of the longest side at least"
        findings.append(Finding(owner, message, hint))
    return [*findings, *misses.findings(nearly)]


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
