"""The structure of ``cover``, as JSON Schema."""

from typing import Any, Final

Schema = dict[str, Any]

DEFAULT_SHARE: Final = 0.98
DEFAULT_OVERLAP: Final = 0.75
DEFAULT_SIDELAP: Final = 0.65


def _pair(description: str, least: float, most: float, example: list[float]) -> Schema:
    return {
        "description": description,
        "type": "array",
        "items": {"type": "number", "minimum": least, "maximum": most},
        "minItems": 2,
        "maxItems": 2,
        "examples": [example],
    }


def _share(description: str, default: float) -> Schema:
    return {"description": description, "type": "number", "minimum": 0.0, "maximum": 0.95, "default": default}


_CAMERA: Final[Schema] = {
    "description": "A camera that looks straight down, its image's width across the lanes; from it and the altitude "
    "follow how far apart the lanes are and the images in a lane.",
    "type": "object",
    "additionalProperties": False,
    "properties": {
        "field_of_view_deg": _pair("Angles of view across and along the lanes, degrees.", 1.0, 170.0, [73.0, 53.0]),
        "sensor_mm": _pair(
            "Width and height of the sensor, mm, across and along the lanes.", 0.1, 1_000.0, [13.2, 8.8]
        ),
        "focal_length_mm": {
            "description": "Focal length, mm.",
            "type": "number",
            "minimum": 0.1,
            "maximum": 10_000.0,
            "examples": [8.8],
        },
        "overlap": _share("Share of an image that the next one in its lane shows too.", DEFAULT_OVERLAP),
        "sidelap": _share("Share of an image that the one in the next lane shows too.", DEFAULT_SIDELAP),
    },
    "oneOf": [{"required": ["field_of_view_deg"]}, {"required": ["sensor_mm"]}],
    "dependentRequired": {"sensor_mm": ["focal_length_mm"], "focal_length_mm": ["sensor_mm"]},
    "examples": [{"field_of_view_deg": [73.0, 53.0], "overlap": 0.75, "sidelap": 0.65}],
}

COVER: Final[Schema] = {
    "description": "A visit of this region is complete when lanes have covered it. Only regions to survey have it.",
    "type": "object",
    "additionalProperties": False,
    "properties": {
        "spacing_m": {
            "description": "Distance between lanes, m.",
            "type": "number",
            "minimum": 0.5,
            "maximum": 10_000.0,
            "examples": [12.0],
        },
        "camera": _CAMERA,
        "heading_deg": {
            "description": "Heading of the lanes, degrees clockwise from north; auto: the one that takes least time.",
            "anyOf": [{"const": "auto"}, {"type": "number", "minimum": -360.0, "maximum": 360.0}],
            "default": "auto",
            "examples": ["auto", 35.0],
        },
        "share": {
            "description": "The share of the region that the flight must really cover, or it is not achieved.",
            "type": "number",
            "minimum": 0.0,
            "maximum": 1.0,
            "default": DEFAULT_SHARE,
        },
    },
    "oneOf": [{"required": ["spacing_m"]}, {"required": ["camera"]}],
    "examples": [{"spacing_m": 12.0}],
}
