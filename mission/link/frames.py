"""The one place where the planner's frame and MAVLink's meet.

The domain is ENU (x east, y north, z up, angles counter-clockwise from east); MAVLink's local frame is NED (x north,
y east, z down, headings clockwise from north). One becomes the other by exchanging x and y and turning z round, which
is its own inverse. It is done component by component, never by a matrix, so that a NaN of one component stays there.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

Vector = tuple[float, float, float]


def ned_from_enu(vector: Vector) -> Vector:
    """A vector given east, north, up as north, east, down, in the same unit."""
    east, north, up = vector
    return north, east, -up


def enu_from_ned(vector: Vector) -> Vector:
    """A vector given north, east, down as east, north, up, in the same unit."""
    north, east, down = vector
    return east, north, -down


def angles_of(quaternion: Sequence[float]) -> Vector:
    """Roll, pitch and yaw of the rotation from body to NED that a quaternion w, x, y, z of length 1 stands for."""
    w, x, y, z = quaternion
    roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = math.asin(min(max(2.0 * (w * y - z * x), -1.0), 1.0))
    return roll, pitch, math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def wrapped(angle_rad: float) -> float:
    """The same angle in [-pi, pi)."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi


@dataclass(frozen=True)
class Anchor:
    """Ties the domain's frame to the vehicle's local frame.

    Attributes:
        origin_ned_m: Where the domain's origin lies, at the height of the take-off point, in the vehicle's local
            frame, whose own origin is wherever its estimator put it.
    """

    origin_ned_m: Vector

    @classmethod
    def between(cls, vehicle_ned_m: Vector, domain_m: Vector) -> "Anchor":
        """The anchor by which the vehicle's local position and the domain's position are the same place."""
        north, east, down = ned_from_enu(domain_m)
        return cls((vehicle_ned_m[0] - north, vehicle_ned_m[1] - east, vehicle_ned_m[2] - down))

    def to_vehicle(self, position_m: Vector) -> Vector:
        """A position in the domain (ENU, metres) in the vehicle's local frame (NED, metres)."""
        north, east, down = ned_from_enu(position_m)
        return north + self.origin_ned_m[0], east + self.origin_ned_m[1], down + self.origin_ned_m[2]

    def to_domain(self, position_ned_m: Vector) -> Vector:
        """A position in the vehicle's local frame (NED, metres) in the domain (ENU, metres)."""
        north, east, down = (position_ned_m[k] - self.origin_ned_m[k] for k in range(3))
        return enu_from_ned((north, east, down))


Anchoring = Callable[[Vector], Anchor]
"""Makes the anchor from the vehicle's local position (NED, metres) at the moment of take-off."""
