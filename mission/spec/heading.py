"""Where the nose is to look: ``flight.heading`` of a mission file, as a schema, as frozen values, and as data again."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Final

from mission.spec.shape_schema import Schema, mapping, number

Data = dict[str, Any]


class Look(StrEnum):
    """What the nose is turned to, by its word in the file."""

    AHEAD = "ahead"
    FIXED = "fixed"
    LANES = "lanes"
    TOWARD = "toward"


@dataclass(frozen=True)
class Heading:
    """Where the nose looks.

    Attributes:
        look: What it is turned to.
        fixed_rad: Of ``fixed``, clockwise from north.
        region: Of ``toward``, the region at whose centre it looks.
    """

    look: Look
    fixed_rad: float = 0.0
    region: str = ""


YAW_RATE_DEG_S: Final = 45.0
"""PX4's MPC_YAWRAUTO_MAX was this up to version 1.15 and is 60 since; ArduCopter's ATC_SLEW_YAW is 60."""

HEADING_SCHEMA: Final[Schema] = {
    "description": "Where the nose looks. ahead: where it flies; lanes: along each lane that is covered from its begin "
    "on, ahead elsewhere; or one heading, or toward a region. The vehicle waits where it has to turn, and is slow "
    "where its nose could not follow. Without it the nose follows the flight as well as it can, and nothing waits for "
    "it. Pictures are taken along their lanes in any case.",
    "anyOf": [
        mapping(
            "One heading, or a region.",
            (),
            {
                "fixed": number("Degrees clockwise from north.", -360.0, 360.0, examples=[90.0]),
                "toward": {"$ref": "#/$defs/region_name"},
            },
            oneOf=[{"required": [Look.FIXED.value]}, {"required": [Look.TOWARD.value]}],
            examples=[{"fixed": 90.0}, {"toward": "S1"}],
        ),
        {"type": "string", "enum": [Look.AHEAD.value, Look.LANES.value]},
    ],
    "examples": [Look.AHEAD.value, Look.LANES.value, {"fixed": 90}, {"toward": "S1"}],
}

YAW_RATE_SCHEMA: Final[Schema] = number(
    "Largest yaw rate, degrees/s. Both autopilots turn as fast as that by their defaults.",
    10.0,
    360.0,
    default=YAW_RATE_DEG_S,
)


def heading_of(data: str | Data | None) -> Heading | None:
    """The values of data that fits the schema; None where the file says nothing of it."""
    if data is None:
        return None
    if isinstance(data, str):
        return Heading(Look(data))
    if Look.FIXED in data:
        return Heading(Look.FIXED, fixed_rad=math.radians(float(data[Look.FIXED])))
    return Heading(Look.TOWARD, region=str(data[Look.TOWARD]))


def heading_data(heading: Heading) -> str | Data:
    """The data that ``heading_of`` reads as these values."""
    if heading.look is Look.FIXED:
        return {Look.FIXED.value: math.degrees(heading.fixed_rad)}
    return {Look.TOWARD.value: heading.region} if heading.look is Look.TOWARD else heading.look.value


def heading_text(heading: Heading | None) -> str:
    """Where the nose looks, in words that go on from "the nose"; empty where the mission says nothing."""
    if heading is None:
        return ""
    if heading.look is Look.FIXED:
        return f"looks to {math.degrees(heading.fixed_rad) % 360.0:.6g} degrees from north"
    ways = {Look.AHEAD: "looks ahead", Look.LANES: "looks along lanes, ahead elsewhere"}
    return ways.get(heading.look, f"looks toward {heading.region}")
