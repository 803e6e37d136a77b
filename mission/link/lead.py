"""What a flight is led by once it departs: a course tied to the ground that the vehicle took off from."""

import math

from mission.link.arrival import Arrival
from mission.link.course import Course
from mission.link.events import Anchored, Moved, SetpointSent
from mission.link.frames import Anchor, Anchoring, enu_from_ned
from mission.link.leading import Leader, leader
from mission.link.steps import Scene
from mission.link.values import LocalPosition, LocalSetpoint
from mission.link.vehicle_state import VehicleState


class Lead:
    """The leader of one flight, from departure on.

    Attributes:
        course: What is flown; None before departure.
        guidance: What leads the vehicle; None before it is armed.
        ground_down_m: The down coordinate of the take-off point in the vehicle's frame; None before it is armed.
    """

    def __init__(self, vehicle: VehicleState, period_s: float, arrival: Arrival) -> None:
        """Lead nothing yet; a setpoint is sent every ``period_s`` of vehicle time, and comes by ``arrival``."""
        self.course: Course | None = None
        self.guidance: Leader | None = None
        self.ground_down_m: float | None = None
        self._anchoring: Anchoring | None = None
        self._vehicle, self._period_s, self._arrival = vehicle, period_s, arrival

    @property
    def altitude_m(self) -> float:
        """Height above the take-off point that is reported; 0 before take-off."""
        position, ground = self._vehicle.position, self.ground_down_m
        return 0.0 if position is None or ground is None else ground - position.position_ned_m[2]

    @property
    def by_field(self) -> bool:
        """Whether the field leads, where the vehicle is, and no trajectory."""
        return self.course is not None and self.course.orders is not None

    def depart(self, course: Course, anchoring: Anchoring) -> None:
        """Lead along this course from where the vehicle is armed."""
        self.course, self._anchoring = course, anchoring

    def take_over(self, course: Course, anchor: Anchor) -> Anchored:
        """Lead a vehicle that is in the air already along this course, tied to the ground that it took off from."""
        self.course = course
        return self._tie(course, anchor)

    def take_ground(self) -> Anchored | None:
        """Where the vehicle is armed, there is the ground, and the domain is tied to it, once."""
        position = self._vehicle.position
        waits = self.ground_down_m is None and position is not None and self._vehicle.armed
        if not waits or position is None or self.course is None or self._anchoring is None:
            return None
        return self._tie(self.course, self._anchoring(position.position_ned_m))

    def _tie(self, course: Course, anchor: Anchor) -> Anchored:
        self.ground_down_m = anchor.origin_ned_m[2]
        self.guidance = leader(course, anchor, self._period_s, self._arrival)
        return Anchored(self._vehicle.position_at_s, anchor.origin_ned_m)

    def moved(self, report: LocalPosition) -> Moved | None:
        """What a report tells in the domain; None before the domain is tied to the ground."""
        if self.guidance is None:
            return None
        at_s = self._vehicle.position_at_s
        position = self.guidance.anchor.to_domain(report.position_ned_m)
        velocity = enu_from_ned(report.velocity_ned_m_s)
        attitude = None if self._vehicle.attitude is None else self._vehicle.attitude.angles_rad
        planned = self.guidance.observe(at_s, position, velocity, attitude)
        return Moved(at_s, position, velocity, attitude, *planned[:2], self.guidance.trajectory_s(at_s))

    def due(self, vehicle_s: float) -> tuple[LocalSetpoint, SetpointSent] | None:
        """The setpoint to send now, and what is to be told of it; None where none is due."""
        due = None if self.guidance is None else self.guidance.due(vehicle_s)
        if self.guidance is None or due is None:
            return None
        reference, setpoint, gap = due
        at_s = self.guidance.arrives_s
        return setpoint, SetpointSent(at_s, reference, setpoint.yaw_rad, self.guidance.trajectory_s(at_s), gap)

    def photographed_s(self, vehicle_s: float) -> float | None:
        """Time on the trajectory at which what is sent now arrives, of laps in the first one; None off it."""
        at_s = vehicle_s + self._arrival.delay_s
        trajectory_s = None if self.guidance is None else self.guidance.trajectory_s(at_s)
        if self.guidance is None or trajectory_s is None:
            return None
        return self.guidance.course.first_lap_s(trajectory_s)

    def scene(self, vehicle_s: float, in_step_s: float, disarmed_s: float) -> Scene:
        """What a step is judged by that has lasted so long."""
        guidance, position = self.guidance, self._vehicle.position
        return Scene(
            vehicle=self._vehicle,
            in_step_s=in_step_s,
            altitude_m=0.0 if self.course is None else self.course.altitude_m,
            height_m=self.altitude_m,
            climb_m_s=0.0 if position is None else -position.velocity_ned_m_s[2],
            off_m=math.inf if guidance is None else guidance.off_m,
            steady_s=0.0 if guidance is None else guidance.steady_s(vehicle_s),
            left_s=math.inf if guidance is None else guidance.left_s(vehicle_s),
            disarmed_s=disarmed_s,
        )
