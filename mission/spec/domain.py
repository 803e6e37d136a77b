"""The domain of a mission: its mesh, its labels, and everything that may be wrong with its geometry."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Final

import numpy as np

from mission.decimals import decimal, measure
from mission.errors import Fault, GeometryError, SpecError
from mission.geometry.arrangement import arranged
from mission.geometry.arrays import BoolArray
from mission.geometry.faces import FacedMesh
from mission.geometry.location import Locator
from mission.geometry.refinement import finest_m, refined
from mission.geometry.regions import Labelling, label_triangles
from mission.geometry.rings import ring_edges
from mission.geometry.shapes import edges_of, edges_within
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import SLIVER, EdgesInMesh, slivers, triangulate_nodes
from mission.spec.areas import Ground, boundary_ground
from mission.spec.drawn_rings import DrawnRing
from mission.spec.finding import Finding, Path, dotted, listed
from mission.spec.model import (
    BoundaryDomain,
    MissionSpec,
    NodesDomain,
    Point,
    PointShape,
    Region,
    TriangleShape,
)
from mission.spec.moving import examine_motion
from mission.spec.outlines import BOUNDARY, Outlines, place, sound_outlines
from mission.spec.scale import pair
from mission.spec.start_check import NO_TUBE, Tube, reach, start_findings

Domain = NodesDomain | BoundaryDomain

_REMEMBERED: Final = 3
"""Maps that are remembered: of the mission that is flown, of the one that comes in its place, and of one more."""


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
    names = frozenset(region.name for region in spec.regions if region.forbidden)
    of_letters = np.array([bool(names & letter) for letter in labelling.letters])
    mask: BoolArray = of_letters[labelling.letter_of]
    return mask


def examine_domain(
    domain: Domain, regions: Sequence[Region], start_m: Point | None, tube: Tube = NO_TUBE
) -> tuple[Partition | None, Labelling | None, list[Finding]]:
    """Mesh as far as it can be had, labels where nothing is wrong, and everything that is wrong.

    Args:
        domain: Nodes or boundary.
        regions: Those whose shape is known.
        start_m: Where the flight begins; None where that is unknown.
        tube: What the proof adds to its path.
    """
    outlines, found_before, mesh = drawn_map(domain, tuple(map(as_drawn, regions)))
    findings = list(found_before)
    if mesh is None:
        return None, None, findings
    partition = mesh.partition
    if isinstance(domain, NodesDomain):
        findings.extend(_missing_edges(partition, outlines.rings))
    locator = Locator(partition)
    members: dict[str, BoolArray] = {}
    for region in regions:
        ground = outlines.grounds.get(region.name)
        if ground is not None:
            members[region.name] = mesh.inside(ground.kept)
            if isinstance(domain, BoundaryDomain) and not members[region.name].any() and _is_plain(ground, outlines):
                own = next(
                    (ring.path for ring in outlines.rings if ring.region == region.name), ("regions", region.name)
                )
                findings.append(_vanished(own, region.name, joined_m(partition.extent_m)))
        elif isinstance(region.shape, TriangleShape | PointShape):
            members[region.name], found = _members(region.name, region.shape, partition, locator)
            findings.extend(found)
    findings.extend(_degenerate(partition, domain, outlines))
    if start_m is not None:
        restricted = {region: members[region.name] for region in regions if _forbids(region) and region.name in members}
        findings.extend(start_findings(start_m, locator, restricted, outlines, tube))
    if not findings:
        findings.extend(examine_motion(domain, regions, partition, members)[1])
    findings = list(dict.fromkeys(findings))
    return partition, None if findings else label_triangles(partition.size, members), findings


def as_drawn(region: Region) -> Region:
    """A region as it is on the map, whatever is done there."""
    return Region(region.name, region.kind, region.shape, clearance_m=region.clearance_m)


@lru_cache(maxsize=_REMEMBERED)
def drawn_map(domain: Domain, regions: tuple[Region, ...]) -> tuple[Outlines, tuple[Finding, ...], FacedMesh | None]:
    """The outlines of a domain with regions, what is wrong with them, and the mesh; None where there is none.

    A mission is checked when it is read, and meshed for that, before it is known what is done in its regions; the same
    mesh serves for what is planned then.
    """
    outlines, findings = sound_outlines(domain, regions)
    if any(finding.path[0] == "domain" for finding in findings):
        return outlines, tuple(findings), None
    try:
        return outlines, tuple(findings), _meshed(domain, outlines)
    except GeometryError as error:
        return outlines, (*findings, _no_mesh(domain, error)), None


def joined_m(extent_m: float) -> float:
    """What is closer than this is joined in the mesh of a domain of some extent."""
    return min(0.01, 1e-4 * extent_m)


def _forbids(region: Region) -> bool:
    return region.forbidden


def _is_plain(ground: Ground, outlines: Outlines) -> bool:
    """Whether no clearance may have taken an area away."""
    return ground.clearance_m == 0.0 and (outlines.fence is None or outlines.fence.clearance_m == 0.0)


def _meshed(domain: Domain, outlines: Outlines) -> FacedMesh:
    """The mesh; over nodes, edges of the outlines may be missing in it."""
    if isinstance(domain, NodesDomain):
        return FacedMesh.of(triangulate_nodes(np.array(domain.nodes_m)))
    fence = (outlines.fence or boundary_ground(domain)).kept
    rims, areas = edges_of([fence]), edges_of(ground.kept for ground in outlines.grounds.values())
    # What sticks out is cut off before it is meshed: vertices out there would only make triangles inside smaller.
    return refined(
        arranged(np.concatenate((rims, edges_within(areas, fence))), joined_m(outlines.extent_m)),
        fence,
        smallest_angle_deg=domain.refinement.smallest_angle_deg,
        largest_m=domain.refinement.largest_m,
    )


def _missing_edges(mesh: Partition, rings: Sequence[DrawnRing]) -> list[Finding]:
    """What to do about edges that are missing in a mesh of nodes."""
    if not rings:
        return []
    owners = [(ring, index) for ring in rings for index in range(len(ring.corners_m))]
    edges = np.concatenate([ring_edges(ring.corners_m) for ring in rings])
    found = EdgesInMesh.of(mesh, edges)
    gaps = mesh.vertices_m[found.links[~found.present]].mean(axis=1)
    gap_of = found.edge_of[~found.present]
    findings = []
    for edge in found.missing.tolist():
        ring, index = owners[edge]
        a, b = edges[edge]
        message = f"the edge of {ring.region} from {place(a)} to {place(b)} is no edge of the mesh"
        middles = listed(map(pair, gaps[gap_of == edge]), most=4)
        hint = f"other points are too near; add to domain.nodes a point on each gap in the edge, such as {middles}"
        findings.append(Finding((*ring.path, index), message, hint))
    return findings


def _members(
    name: str, shape: TriangleShape | PointShape, partition: Partition, locator: Locator
) -> tuple[BoolArray, list[Finding]]:
    """Mask of the one triangle of a region, shape (M,), and what is wrong with its shape."""
    if isinstance(shape, TriangleShape):
        # Three different nodes, each of them among the three of the triangle: the order does not matter.
        mask = np.ones(partition.size, dtype=np.bool_)
        for node in shape.nodes:
            mask &= np.logical_or.reduce(np.equal(partition.triangles.T, node))
        return mask, [] if mask.any() else [_no_such_triangle(name, shape.nodes, partition)]
    touching = locator.triangles_touching(shape.point_m)
    mask = np.zeros(partition.size, dtype=np.bool_)
    mask[touching] = True
    if len(touching) == 1:
        return mask, []
    return mask, [_no_one_triangle(name, shape.point_m, touching.tolist(), partition)]


def _no_mesh(domain: Domain, error: GeometryError) -> Finding:
    if isinstance(domain, NodesDomain):
        return Finding(("domain", "nodes"), str(error), "three nodes at least must not lie on one line")
    wanted = domain.refinement
    finest = finest_m(boundary_ground(domain).kept.area)
    if wanted.largest_m < finest:
        hint = f"write more than {measure(2.0 * finest)}, or leave it out"
        return Finding(("domain", "mesh", "largest_m"), str(error), hint)
    hint = (
        "let outlines that run very close to each other meet, or write a larger `largest_m` or `smallest_angle_deg: 20`"
    )
    return Finding(("domain", "mesh"), str(error), hint)


def _vanished(path: Path, name: str, joined: float) -> Finding:
    message = f"nothing is left of {name} in the mesh, in which whatever is closer than {measure(joined)} m is joined"
    return Finding(path, message, "make it larger, or take it away")


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
        return Finding(path, f"the point {place(point)} of {name} lies outside the domain", reach(partition))
    message = f"the point {place(point)} of {name} lies on an edge between triangles"
    inside = listed(map(pair, partition.incentres_m[touching[:6]]))
    return Finding(path, message, f"move it inside one of them, such as {inside}")


def _degenerate(partition: Partition, domain: Domain, outlines: Outlines) -> list[Finding]:
    # The lists of the file that the vertices of the mesh come from.
    sources = [(ring.path, ring.corners_m) for ring in outlines.rings]
    if isinstance(domain, NodesDomain):
        sources = [(("domain", "nodes"), np.array(domain.nodes_m))]
    owners: list[Path] = [(*path, index) for path, points in sources for index in range(len(points))]
    places = np.concatenate([np.empty((0, 2)), *(points for _, points in sources)])
    findings = []
    for index in slivers(partition).tolist():
        longest = int(np.argmax(partition.edge_lengths_m[index]))
        # The corner opposite the longest side is the one that lies on it, or one of two that lie together.
        corner = partition.corners_m[index, longest]
        owner = owners[int(np.argmin(np.linalg.norm(places - corner, axis=1)))] if owners else BOUNDARY
        corners = " ".join(place(corner) for corner in partition.corners_m[index])
        height, side = partition.heights_m[index].min(), partition.edge_lengths_m[index].max()
        message = f"the triangle {corners} is degenerate: {measure(height)} m high on a side of {measure(side)} m"
        hint = f"move this corner or take it away; the height must be {decimal(SLIVER)} of the longest side at least"
        findings.append(Finding(owner, message, hint))
    return findings
