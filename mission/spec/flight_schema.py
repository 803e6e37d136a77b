"""How a mission is flown, as a part of the schema."""

from typing import Final

from mission.spec.heading import HEADING_SCHEMA
from mission.spec.model import FIELD, TRAJECTORY
from mission.spec.shape_schema import mapping, number
from mission.spec.tube import TUBE_SCHEMA

FLIGHT: Final = mapping(
    "How it is flown.",
    (),
    {
        "speed_m_s": number(
            "Speed where nothing hinders, c of the paper's fields, m/s; by default that of the limits.",
            0.001,
            100.0,
            examples=[3.0],
        ),
        "altitude_m": number("Height above the take-off point, m.", 0.5, 5_000.0, default=10.0),
        "final_stay_s": number("How long to stay in the last triangle before landing, s.", 0.1, 86_400.0, default=5.0),
        "time_constant_s": number("Time constant tau of the tracking law, s.", 0.05, 100.0, default=1.0),
        "disturbance_m_s2": number(
            "Bound on each axis of the acceleration that tracking does not know of, m/s2; the certificate widens the "
            "path by it.",
            0.0,
            20.0,
            default=0.0,
        ),
        "tube": TUBE_SCHEMA,
        "guidance": {
            "description": "What leads the vehicle: the trajectory that is proved, by its time law, or at each moment "
            "the control to a facet of the triangle in which it is, from wherever it was pushed or flown by a pilot.",
            "enum": [TRAJECTORY, FIELD],
            "default": TRAJECTORY,
        },
        "heading": HEADING_SCHEMA,
        "replan": {
            "description": "Whether a flight that has left the tube of its trajectory goes on by another plan, made "
            "from where it is.",
            "type": "boolean",
            "default": False,
        },
        "longest_s": number(
            "How long the flight may take from arming to landing, s, taking off and landing reckoned as autopilots do "
            "it; without it, as long as it takes.",
            1.0,
            1.0e6,
            examples=[600],
        ),
    },
    examples=[{"speed_m_s": 3.0, "altitude_m": 10.0}],
)
