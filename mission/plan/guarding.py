"""A plan's fence as one that guards a flight: it never meets the tube, and the autopilot has room for it.

**Which outline.** The fence is where clearances end. The certificate of a plan says that the square of the tube round
each place of its path lies in the domain and meets nothing restricted, clearances included; so a vehicle whose own
estimate stays within the tube is never beyond the fence. It is neither nearer to what is restricted, where it would let
the vehicle come closer than the mission allows, nor farther away, where it would end flights that are as proved.

**Which frame.** A flight goes by the vehicle's local frame, in metres; a fence is kept and watched in degrees.
Autopilots convert one to the other on a sphere, the mission on the ellipsoid, so at a distance d of the frame's origin
the two are up to s d apart, where s compares the sphere with the ellipsoid's radii of curvature (``frame_share``).
``opened`` moves each outline away from the flight by so much and by the rounding of places. If F is where the plan's
tube may be, then the vehicle in its tube is in F by its metres, within s d of F by its degrees, and F grown by that is
within the fence. An area so thin that nothing would be left of it stays as it is: rather a flight that ends too early.

**How many corners.** ``thinned`` leaves out corners, the flattest first, so that the fence only ever gets farther from
the flight: of what is to be stayed out of corners that stick out, of what is to be stayed in those that point inwards.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely

from mission.geometry.geodesy import curvature_radii_m
from mission.plan.fence import Circle, Fence, Rim, corners_of
from mission.spec.model import Point

_ROUNDING_M: Final = 0.01
"""Places are whole numbers of 1e-7 degrees: half of that is 6 mm on either axis."""

_FEWEST: Final = 3


@dataclass(frozen=True)
class Room:
    """What an autopilot keeps a fence in, in units of its own.

    Attributes:
        total: All there is.
        area: What a polygon takes.
        corner: What each of its corners takes beside that.
        circle: What a circle takes.
    """

    total: int
    area: int
    corner: int
    circle: int

    def holds(self, fence: Fence) -> bool:
        """Whether there is room for a fence."""
        return sum(map(self._takes, fence.rims)) <= self.total

    def _takes(self, rim: Rim) -> int:
        return self.circle if isinstance(rim, Circle) else self.area + self.corner * len(rim)


def frame_share(radius_m: float, latitude_deg: float, altitude_m: float) -> float:
    """By what share of a distance a frame on a sphere is off, on the worse axis, at a place on the ellipsoid."""
    radii = np.array(curvature_radii_m(latitude_deg)) + altitude_m
    return float(np.abs(radii / radius_m - 1.0).max())


def reach_m(fence: Fence, shift_m: Point) -> float:
    """How far from a frame's origin a fence reaches, where the domain's (0, 0) lies at ``shift_m`` of it."""
    rounds = [(np.array([rim.centre_m]), rim.radius_m) if isinstance(rim, Circle) else (rim, 0.0) for rim in fence.rims]
    return max(float(np.hypot(*(points + np.array(shift_m)).T).max()) + radius_m for points, radius_m in rounds)


def opened(fence: Fence, by_m: float) -> Fence:
    """The fence farther from the flight by so much, and by what places are rounded."""
    step_m = by_m + _ROUNDING_M
    (inclusion,) = _moved(fence.inclusion, step_m)
    return Fence(inclusion, tuple(rim for each in fence.exclusions for rim in _moved(each, -step_m)))


def thinned(fence: Fence, room: Room) -> Fence | None:
    """The fence with so many corners only as there is room for; None where too many would be left."""
    rims = list(fence.rims)
    while not room.holds(thin := Fence(rims[0], tuple(rims[1:]))):
        flattest = [_flattest(rim, outwards=number > 0) for number, rim in enumerate(rims)]
        number = min(range(len(rims)), key=lambda each: flattest[each][0])
        rim, (height_m, corner) = rims[number], flattest[number]
        if isinstance(rim, Circle) or not np.isfinite(height_m):
            return None
        rims[number] = np.delete(rim, corner, axis=0)
    return thin


def _moved(rim: Rim, by_m: float) -> tuple[Rim, ...]:
    """A rim that encloses more by so much, or less; in several parts, where it falls apart."""
    if isinstance(rim, Circle):
        return (Circle(rim.centre_m, rim.radius_m + by_m) if rim.radius_m + by_m > 0.0 else rim,)
    moved = shapely.buffer(shapely.Polygon(rim), by_m, join_style="mitre")
    return (rim,) if moved.is_empty else tuple(corners_of(part) for part in shapely.get_parts(moved))


def _flattest(rim: Rim, *, outwards: bool) -> tuple[float, int]:
    """How high the flattest corner is that can be left out, and its index; infinite where there is none.

    Args:
        rim: A polygon; a circle has no corner.
        outwards: Whether corners that stick out may go, else those that point inwards.
    """
    if isinstance(rim, Circle) or len(rim) <= _FEWEST:
        return np.inf, 0
    before, after = np.roll(rim, 1, axis=0), np.roll(rim, -1, axis=0)
    (along, edge), base = (rim - before, after - rim), after - before
    turn = along[:, 0] * edge[:, 1] - along[:, 1] * edge[:, 0]
    heights = np.abs(turn) / np.maximum(np.hypot(*base.T), 1e-9)
    heights[(turn < 0.0) if outwards else (turn > 0.0)] = np.inf
    for corner in np.argsort(heights, kind="stable").tolist():
        if not np.isfinite(heights[corner]):
            break
        ear = shapely.Polygon([before[corner], rim[corner], after[corner]])
        others = np.delete(rim, [corner - 1, corner, (corner + 1) % len(rim)], axis=0)
        if not shapely.intersects(ear, shapely.points(others)).any():
            return float(heights[corner]), corner
    return np.inf, 0
