"""What leads a vehicle: a trajectory by its time law, or the field where the vehicle is."""

from mission.link.arrival import Arrival
from mission.link.course import Course
from mission.link.field_guidance import FieldGuidance
from mission.link.frames import Anchor
from mission.link.guidance import Guidance

Leader = Guidance | FieldGuidance


def leader(course: Course, anchor: Anchor, period_s: float, arrival: Arrival) -> Leader:
    """By the field where the course has orders for that, else along its trajectory."""
    if course.orders is None:
        return Guidance(course, anchor, period_s, arrival)
    return FieldGuidance(course, course.orders, anchor, period_s, arrival)
