"""The map of a mission whose regions or nodes move: how its mesh goes along, and what may be wrong with that."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Final

import numpy as np
import shapely
from scipy.interpolate import PchipInterpolator

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.carrying import carried_along
from mission.geometry.moving import FLATTEST, MovingPartition, rim_of
from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.spec.finding import Finding, Path, listed
from mission.spec.model import BoundaryDomain, MissionSpec, NodesDomain, Region
from mission.spec.motion import Motion
from mission.spec.outlines import place

_SMOOTH_PARTS: Final = 16
"""Straight parts between two way-points of a smooth motion: it is these."""
_REMEMBERED: Final = 3
_SAME_M: Final = 1e-9
_NOBODY: Final = -1


def motions_by_name(spec: MissionSpec) -> dict[str, Motion]:
    """What of a mission moves, and how: regions by their names, and ``nodes 4, 10``."""
    of_nodes = spec.domain.motions if isinstance(spec.domain, NodesDomain) else ()
    regions = {region.name: region.motion for region in spec.regions if region.motion is not None}
    return regions | {f"node{'s' * (len(nodes) > 1)} {listed(nodes)}": motion for nodes, motion in of_nodes}


def instants_s(motion: Motion) -> FloatArray:
    """Instants between which a motion is straight, shape (K,)."""
    times = np.array([row[0] for row in motion.waypoints])
    if not motion.smooth:
        return times
    shares = np.arange(_SMOOTH_PARTS) / _SMOOTH_PARTS
    return np.append((times[:-1, None] + shares * np.diff(times)[:, None]).ravel(), times[-1])


def displacement_m(motion: Motion, times_s: FloatArray) -> FloatArray:
    """By how much something is displaced at times (P,), shape (P, 2), east and north."""
    rows, knots = np.array(motion.waypoints), instants_s(motion)
    offsets = PchipInterpolator(rows[:, 0], rows[:, 1:])(knots) if motion.smooth else rows[:, 1:]
    return np.stack([np.interp(times_s, knots, offsets[:, axis]) for axis in (0, 1)], axis=1)


def shape_then(
    shape: shapely.Geometry, motion: Motion | None, moving: MovingPartition, triangles: IntArray, time_s: float
) -> shapely.Geometry:
    """A shape that is drawn of a region, at a time: it goes along as a whole, or is what its triangles are then.

    Args:
        shape: As it is drawn.
        motion: The region's own; None where only nodes of it move.
        moving: How the triangles move.
        triangles: Those of the region.
        time_s: On the clock of the trajectory.
    """
    if motion is None:
        return union_of(moving.at(time_s), triangles)
    (offset,) = displacement_m(motion, np.array([time_s]))
    return shapely.transform(shape, lambda points: points + offset)


def moving_of(spec: MissionSpec, partition: Partition, labelling: Labelling) -> MovingPartition | None:
    """How the triangles of a mission move; None where all of them stand still.

    Args:
        spec: The mission, whose motions have no faults.
        partition: Its mesh.
        labelling: Its labels.
    """
    if not spec.moves:
        return None
    members = {region.name: _members(partition, labelling, region.name) for region in spec.regions}
    return examine_motion(spec.domain, spec.regions, partition, members)[0]


def _members(partition: Partition, labelling: Labelling, name: str) -> BoolArray:
    inside = np.zeros(partition.size, dtype=np.bool_)
    inside[labelling.triangles_of(name)] = True
    return inside


def examine_motion(
    domain: NodesDomain | BoundaryDomain,
    regions: Sequence[Region],
    partition: Partition,
    members: dict[str, BoolArray],
) -> tuple[MovingPartition | None, list[Finding]]:
    """How a mesh moves, and what is wrong with that; None where nothing moves or something is wrong.

    A region moves as a whole, with the vertices of its triangles. Over nodes, others that have a vertex in common with
    it go with that; within a boundary they are held where they are. The vertices that belong to no region go along.

    Args:
        domain: Nodes or boundary.
        regions: Those whose shape is known.
        partition: The mesh at first.
        members: Of each region, the mask of its triangles, shape (M,).
    """
    moved, findings = _moved(domain, regions, partition, members)
    if not moved or findings:
        return None, findings
    still = [members[region.name] for region in regions if region.motion is None and region.name in members]
    held = np.zeros(len(partition.vertices_m), dtype=np.bool_)
    if isinstance(domain, BoundaryDomain) and still:
        held = _vertices(partition, np.logical_or.reduce(still))
    times = np.unique(np.concatenate([[0.0], *(instants_s(motion) for _, motion, _ in moved)]))
    places = np.repeat(partition.vertices_m[None], len(times), axis=0)
    owner = np.full(len(partition.vertices_m), _NOBODY)
    for number, (path, motion, own) in enumerate(moved):
        offsets = displacement_m(motion, times)
        findings += _at_odds(partition, path, own & held, rim_of(partition) & own, still=not offsets.any())
        shared = own & (owner != _NOBODY)
        if np.abs((places - partition.vertices_m - offsets[:, None])[:, shared]).max(initial=0.0) > _SAME_M:
            message = f"two motions move the point {_first(partition, shared)} apart"
            hint = "draw the regions apart, or give both the same motion"
            findings.append(Finding(path, message, hint, at_key=True))
        places[:, own] = partition.vertices_m[own] + offsets[:, None]
        owner[own] = number
    if findings:
        return None, findings
    moving = _carried(_Key(partition), times.tobytes(), ((owner != _NOBODY) | held).tobytes(), places.tobytes())
    flat = moving.first_flat()
    if flat is None:
        return moving, []
    corners = partition.triangles[flat.triangle]
    names = " ".join(place(partition.vertices_m[corner]) for corner in corners)
    numbers = f" (nodes {listed(corners.tolist())})" if isinstance(domain, NodesDomain) else ""
    message = (
        f"after {flat.time_s:.1f} s the triangle that is {names}{numbers} at first folds, or is flatter than "
        f"{FLATTEST:.0%} of its longest side"
    )
    finer = "" if isinstance(domain, NodesDomain) else ", or give `domain.mesh` a smaller `largest_m`"
    hint = f"let the motion end before that, lead it farther from what stays{finer}"
    return None, [Finding(moved[max(0, int(owner[corners].max()))][0], message, hint, at_key=True)]


def _moved(
    domain: NodesDomain | BoundaryDomain,
    regions: Sequence[Region],
    partition: Partition,
    members: dict[str, BoolArray],
) -> tuple[list[tuple[Path, Motion, BoolArray]], list[Finding]]:
    """What moves: its place in the file, how, and its vertices as a mask (V,); and nodes that there are not."""
    moved: list[tuple[Path, Motion, BoolArray]] = [
        (("regions", region.name, "motion"), region.motion, _vertices(partition, members[region.name]))
        for region in regions
        if region.motion is not None and region.name in members
    ]
    findings = []
    every = np.arange(len(partition.vertices_m))
    for number, (nodes, motion) in enumerate(domain.motions if isinstance(domain, NodesDomain) else ()):
        path: Path = ("domain", "motions", number)
        moved.append((path, motion, np.isin(every, nodes)))
        unknown = [node for node in nodes if node >= len(every)]
        if unknown:
            hint = f"the nodes are numbered from 0 to {len(every) - 1}"
            findings.append(Finding((*path, "nodes"), f"there is no node {listed(unknown)}", hint))
    return moved, findings


def _at_odds(partition: Partition, path: Path, held: BoolArray, rim: BoolArray, *, still: bool) -> Iterator[Finding]:
    """Vertices (V,) that a motion would move, and that are held, or lie on the boundary."""
    for mask, what in ((rim, "on the boundary of the domain, which stays"), (held, "a corner of a region that stays")):
        if mask.any() and not still:
            message = f"it would move the point {_first(partition, mask)}, which is {what}"
            yield Finding(path, message, "draw it apart from that, or take `motion` away", at_key=True)
            return


def _first(partition: Partition, vertices: BoolArray) -> str:
    return place(partition.vertices_m[int(np.flatnonzero(vertices)[0])])


def _vertices(partition: Partition, triangles: BoolArray) -> BoolArray:
    """The vertices of some triangles (M,), shape (V,)."""
    own = np.zeros(len(partition.vertices_m), dtype=np.bool_)
    own[partition.triangles[triangles]] = True
    return own


class _Key:
    """A partition, equal to another one of the same vertices and triangles."""

    def __init__(self, partition: Partition) -> None:
        self.partition = partition
        self._of = (partition.vertices_m.tobytes(), partition.triangles.tobytes())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and self._of == other._of

    def __hash__(self) -> int:
        return hash(self._of)


@lru_cache(maxsize=_REMEMBERED)
def _carried(key: _Key, times: bytes, moved: bytes, places: bytes) -> MovingPartition:
    instants = np.frombuffer(times)
    shape = (len(instants), *key.partition.vertices_m.shape)
    return carried_along(
        key.partition, instants, np.frombuffer(moved, dtype=np.bool_), np.frombuffer(places).reshape(shape)
    )
