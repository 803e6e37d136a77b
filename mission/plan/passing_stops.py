"""Stops where a curve comes through a region to loiter in, beside those of visits that the mission asks for.

The stages of a run tell only where its automaton needs a visit. A vehicle loiters each time that it enters a region
which asks for that, so a way that leads through one has a stop there as well: wherever the tube touches the region from
outside and all of it is inside for a while, by the pieces of the proof.
"""

from collections.abc import Iterable
from itertools import groupby

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray
from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.spec.model import Region
from mission.steering.certificate import Certificate
from mission.steering.joined import JoinedCurve

_SAMPLES_A_PIECE = 9

Stops = tuple[tuple[float, float], ...]


def with_passing_stops(
    stops: Stops,
    curve: JoinedCurve,
    certificates: Iterable[Certificate],
    ground: tuple[Partition, Labelling],
    regions: Iterable[Region],
) -> Stops:
    """The stops of a flight with one in each visit of a region to loiter in that has none of that length.

    To begin inside is no visit, nor is it where no piece of the tube is in the region as a whole.

    Args:
        stops: Pairs (curve parameter, seconds).
        curve: The whole curve.
        certificates: Proofs of its parts, one after the other, which together are the whole.
        ground: The triangles and their labels.
        regions: Of the mission.

    Returns:
        In the order of the curve.
    """
    partition, labelling = ground
    knots, sets = pieces_of(certificates)
    found = list(stops)
    for region in sorted(regions, key=lambda each: -each.loiter_s):
        if region.loiter_s <= 0.0:
            continue
        own = np.zeros(partition.size, dtype=np.bool_)
        own[labelling.triangles_of(region.name)] = True
        touched = [any(own[each].tolist()) for each in sets]
        filled = np.array([all(own[each].tolist()) for each in sets])
        for inside, group in groupby(range(len(sets)), key=touched.__getitem__):
            first, *others = group
            pieces = np.array([first, *others])
            if not inside or first == 0 or not filled[pieces].any():
                continue
            begin, end = float(knots[first]), float(knots[pieces[-1] + 1])
            if not any(begin <= s <= end and seconds >= region.loiter_s for s, seconds in found):
                whole = pieces[filled[pieces]]
                outline = union_of(partition, labelling.triangles_of(region.name))
                found.append((_deepest(curve, outline, knots[whole], knots[whole + 1]), region.loiter_s))
    return tuple(sorted(found))


def pieces_of(certificates: Iterable[Certificate]) -> tuple[FloatArray, list[list[int]]]:
    """The ends of the pieces of proofs, and the triangles that the tube may touch in each."""
    knots, sets = [np.zeros(1)], []
    for certificate in certificates:
        knots.append(knots[-1][-1] + certificate.knots_s[1:])
        sets += [list(triangles) for triangles in certificate.possible]
    return np.concatenate(knots), sets


def _deepest(curve: JoinedCurve, outline: shapely.Geometry, begins_s: FloatArray, ends_s: FloatArray) -> float:
    """The place of those between some ends, (K,) each, that is farthest from the rims of a region."""
    s = np.linspace(begins_s, ends_s, _SAMPLES_A_PIECE)[1:-1].ravel()
    depth_m = shapely.distance(shapely.boundary(outline), shapely.points(curve.position(s)))
    return float(s[np.argmax(depth_m)])
