"""What must not be entered, as it is drawn: distances of flights are measured to that."""

import shapely

from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.spec.areas import region_ground
from mission.spec.model import MissionSpec


def restricted_as_drawn(spec: MissionSpec, partition: Partition, labelling: Labelling) -> dict[str, shapely.Geometry]:
    """Restricted regions without their clearances, by their names.

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
