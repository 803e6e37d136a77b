"""The structure of points and shapes in a mission file, as JSON Schema, and what other parts of it are built with."""

from typing import Any, Final

Schema = dict[str, Any]

MAX_COORDINATE_M: Final = 2.0e7
"""Eastings and northings of the map projections in use are less than half the Earth's circumference."""
MOST_CORNERS: Final = 10_000
MOST_PARTS: Final = 1_000


def number(description: str, low: float, high: float, **more: Any) -> Schema:  # noqa: ANN401 - any JSON value
    """A number between two others."""
    return {"description": description, "type": "number", "minimum": low, "maximum": high, **more}


def mapping(description: str, required: tuple[str, ...], properties: Schema, **more: Any) -> Schema:  # noqa: ANN401 - any JSON value
    """A mapping of these keys and no others."""
    schema = {"description": description, "type": "object", "additionalProperties": False, "properties": properties}
    return schema | ({"required": list(required)} if required else {}) | more


def one_of(*keys: str) -> list[Schema]:
    """Exactly one of the keys."""
    return [{"required": [key]} for key in keys]


COORDINATE: Final[Schema] = {"type": "number", "minimum": -MAX_COORDINATE_M, "maximum": MAX_COORDINATE_M}
POINT: Final[Schema] = {
    "description": "A place in the domain, [east, north] in metres, or [latitude, longitude] where `corners` says so.",
    "type": "array",
    "items": COORDINATE,
    "minItems": 2,
    "maxItems": 2,
    "examples": [[12.5, 40.0]],
}

POINT_REFERENCE: Final[Schema] = {"$ref": "#/$defs/point"}
RING: Final[Schema] = {
    "type": "array",
    "items": POINT_REFERENCE,
    "minItems": 3,
    "maxItems": MOST_CORNERS,
    "examples": [[[0, 0], [20, 0], [20, 10]]],
}

ORIGIN: Final = mapping(
    "Where on Earth (WGS 84) the domain's [0, 0] lies. Without it the domain lies so that the vehicle is at the start.",
    ("latitude_deg", "longitude_deg"),
    {
        "latitude_deg": number("Degrees north.", -89.9, 89.9, examples=[47.3977]),
        "longitude_deg": number("Degrees east.", -180.0, 180.0, examples=[8.5456]),
    },
    examples=[{"latitude_deg": 47.3977, "longitude_deg": 8.5456}],
)

_HOLES: Final[Schema] = {
    "description": "Rings of corners, each a hole in the polygon.",
    "type": "array",
    "items": RING | {"description": "Corners of a hole, in order."},
    "maxItems": MOST_PARTS,
    "examples": [[[[5, 2], [15, 2], [15, 5]]]],
}

AREA_SHAPES: Final[Schema] = {
    "polygon": RING
    | {
        "description": "Corners of a simple polygon, in order. Within a boundary it may lie anywhere; over nodes, "
        "each of its edges must be an edge of the mesh."
    },
    "holes": _HOLES,
    "polygons": {
        "description": "Several polygons, each with its holes if it has some.",
        "type": "array",
        "items": mapping(
            "One part.",
            ("polygon",),
            {"polygon": RING | {"description": "Corners of a simple polygon, in order."}, "holes": _HOLES},
        ),
        "minItems": 1,
        "maxItems": MOST_PARTS,
        "examples": [[{"polygon": [[0, 0], [20, 0], [20, 10]]}]],
    },
    "centre": {
        "description": "Centre of a circle, [east, north] in metres.",
        "$ref": "#/$defs/point",
        "examples": [[12.5, 40.0]],
    },
    "radius_m": number("Radius of the circle, m.", 0.1, 100_000.0, examples=[12.0]),
    "line": {
        "description": "Corners of a line, in order: the middle of a strip, which is flat at its ends.",
        "type": "array",
        "items": POINT_REFERENCE,
        "minItems": 2,
        "maxItems": MOST_CORNERS,
        "examples": [[[0, 0], [20, 0], [20, 10]]],
    },
    "width_m": number("Width of the strip from side to side, m.", 0.1, 10_000.0, examples=[8.0]),
    "file": {
        "description": "A file that draws the shape: its path, relative to this file. GeoJSON, KML, KMZ, a plan of "
        "QGroundControl, waypoints or a fence; in degrees, or in metres of the domain.",
        "type": "string",
        "minLength": 1,
        "maxLength": 1_000,
        "examples": ["farm.geojson"],
    },
    "feature": {
        "description": "Which feature of the file: its name, or its index from 0. One alone need not be named.",
        "anyOf": [{"type": "string", "minLength": 1, "maxLength": 1_000}, {"type": "integer", "minimum": 0}],
        "examples": ["north", 0],
    },
}
GO_TOGETHER: Final[Schema] = {
    "dependentRequired": {"feature": ["file"]},
    # A line or a place in a file may take its width or radius from here.
    "if": {"not": {"required": ["file"]}},
    "then": {
        "dependentRequired": {
            "holes": ["polygon"],
            "centre": ["radius_m"],
            "radius_m": ["centre"],
            "line": ["width_m"],
            "width_m": ["line"],
        }
    },
}
AREAS: Final = ("polygon", "polygons", "centre", "line", "file")
"""The keys of which a shape has exactly one."""
