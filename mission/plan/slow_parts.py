"""Where along a path the vehicle must be slow, since the mission says so of a region."""

import math
from itertools import pairwise
from typing import Final

import numpy as np
import shapely

from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.spec.model import MissionSpec
from mission.steering.enclosure import enclose
from mission.steering.grid import Slow
from mission.steering.joined import JoinedCurve

_CELLS: Final = 512
_CELLS_PER_WAVE: Final = 8


def slow_parts(spec: MissionSpec, partition: Partition, labelling: Labelling, curve: JoinedCurve) -> tuple[Slow, ...]:
    """The parts of a curve on which the tube may be in a region with a largest speed.

    Between two places the curve stays within a proved distance of its chord, so no part is left out.
    """
    slow = [region for region in spec.regions if region.speed_m_s is not None]
    if not slow:
        return ()
    enclosure = enclose(curve, max(_CELLS, _CELLS_PER_WAVE * curve.frequencies))
    knots = enclosure.knots_s
    chords = shapely.linestrings(np.stack((enclosure.points_m[:-1], enclosure.points_m[1:]), axis=1))
    reach_m = math.sqrt(2.0) * spec.flight.tube_m + enclosure.remainder_m
    parts = []
    for region in slow:
        outline = union_of(partition, labelling.triangles_of(region.name))
        shapely.prepare(outline)
        near = np.concatenate(([False], shapely.dwithin(outline, chords, reach_m), [False]))
        for begin, end in pairwise(np.flatnonzero(near[1:] != near[:-1]).tolist()):
            if near[begin + 1]:
                parts.append(Slow(float(knots[begin]), float(knots[end]), speed_m_s=region.speed_m_s or math.inf))
    return tuple(parts)
