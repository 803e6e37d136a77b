"""Where along a path the vehicle must be slow, since the mission says so of a region."""

from collections.abc import Iterable
from itertools import groupby

import numpy as np

from mission.geometry.regions import Labelling
from mission.plan.passing_stops import pieces_of
from mission.spec.model import Region
from mission.steering.certificate import Certificate
from mission.steering.grid import Slow


def slow_parts(
    certificates: Iterable[Certificate], labelling: Labelling, regions: Iterable[Region]
) -> tuple[Slow, ...]:
    """The parts of a curve on which the tube may be in a region with a largest speed, by the pieces of its proofs."""
    knots, sets = pieces_of(certificates)
    parts = []
    for region in regions:
        if region.speed_m_s is None:
            continue
        own = np.isin(np.arange(len(labelling.letter_of)), labelling.triangles_of(region.name))
        touched = [bool(own[each].any()) for each in sets]
        for inside, group in groupby(range(len(sets)), key=touched.__getitem__):
            first, *others = group
            if inside:
                end = [first, *others][-1] + 1
                parts.append(Slow(float(knots[first]), float(knots[end]), speed_m_s=region.speed_m_s))
    return tuple(parts)
