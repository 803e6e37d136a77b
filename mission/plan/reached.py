"""Where lanes and ways between them may lie, as far as they are reached from one place."""

from typing import Final

import numpy as np
import shapely

from mission.errors import NoPlanError
from mission.spec.model import Point, Region

_QUARTER: Final = 16  # chords of a quarter circle


def reached(
    region: Region, ground: shapely.Geometry, ways: shapely.Geometry, place: shapely.Point, why: str
) -> tuple[shapely.Geometry, shapely.Geometry]:
    """Of the ground and of where ways may lie, what a place is connected with.

    Raises:
        NoPlanError: More of the ground is not than the mission leaves uncovered; ``why`` is what else there is to say.
    """
    parts = shapely.get_parts(ways)
    if ground.is_empty or len(parts) < 2:  # noqa: PLR2004 - nothing is apart
        return ground, ways
    here = parts[np.argmin(shapely.distance(parts, place))]
    pieces = shapely.get_parts(ground)
    near = shapely.intersects(pieces, here)
    lost = shapely.area(pieces[~near])
    if region.cover is not None and lost.sum() > (1.0 - region.cover.share) * ground.area:
        x, y = shapely.get_coordinates(shapely.point_on_surface(pieces[~near][np.argmax(lost)]))[0]
        raise NoPlanError(
            f"{region.name} cannot be covered: no way leads to {lost.sum() / ground.area:.1%} of it, about "
            f"({x:.1f}, {y:.1f}), from ({place.x:.1f}, {place.y:.1f}), where its lanes begin and end; leave that out, "
            f"visit it as a region of its own, or set a lower `regions.{region.name}.cover.share`{why}",
            regions=(region.name,),
        )
    return shapely.union_all(pieces[near]), here


def nearest_m(area: shapely.Geometry, place_m: Point) -> Point:
    """The nearest place of an area."""
    (x, y), _ = shapely.get_coordinates(shapely.shortest_line(area, shapely.Point(place_m)))
    return float(x), float(y)


def shrunk(shape: shapely.Geometry, margin_m: float) -> shapely.Geometry:
    """A shape without what is nearer to its rim than a margin."""
    return shapely.buffer(shape, -margin_m, quad_segs=_QUARTER) if margin_m > 0.0 else shape
