"""What must not be entered, as it is drawn: distances of flights are measured to that."""

from collections.abc import Callable
from functools import partial

import shapely

from mission.geometry.moving import MovingPartition
from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.spec.areas import region_ground
from mission.spec.model import MissionSpec
from mission.spec.moving import shape_then

ShapeAt = Callable[[float], shapely.Geometry]
"""Where something is at a time on the clock of the trajectory."""


def restricted_as_drawn(spec: MissionSpec, partition: Partition, labelling: Labelling) -> dict[str, shapely.Geometry]:
    """Restricted regions without their clearances, by their names, where they are at first.

    Args:
        spec: The mission.
        partition: Its triangles, of which a region may be one.
        labelling: Their labels.
    """
    restricted = [region for region in spec.regions if region.forbidden]
    grounds = {region.name: region_ground(region, spec.domain) for region in restricted}
    return {
        name: union_of(partition, labelling.triangles_of(name)) if ground is None else ground.drawn
        for name, ground in grounds.items()
    }


def restricted_that_move(spec: MissionSpec, labelling: Labelling, moving: MovingPartition | None) -> dict[str, ShapeAt]:
    """Where those of them that move are, by their names.

    Args:
        spec: The mission.
        labelling: The labels of its triangles.
        moving: How these move; None where all of them stand still.
    """
    if moving is None:
        return {}
    drawn = restricted_as_drawn(spec, moving.fixed, labelling)
    motions = {region.name: region.motion for region in spec.regions}
    triangles = {name: labelling.triangles_of(name) for name in drawn}
    return {
        name: partial(shape_then, shape, motions[name], moving, triangles[name])
        for name, shape in drawn.items()
        if moving.moves[moving.fixed.triangles[triangles[name]]].any()
    }
