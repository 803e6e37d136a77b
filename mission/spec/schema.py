"""The structure of a mission file as a JSON Schema (2020-12): for editors, for the loader, and for its defaults.

What no schema can say (a formula that parses, a start inside the domain, edges that cross) is in ``check.py`` and
``domain.py``.
"""

from copy import deepcopy
from typing import Any, Final

from mission.logic.formula.parser import MAX_LENGTH
from mission.spec.battery import BATTERY_SCHEMA
from mission.spec.cover_schema import COVER
from mission.spec.flight_schema import FLIGHT
from mission.spec.heading import YAW_RATE_SCHEMA
from mission.spec.model import (
    CORRIDOR,
    MOST_LAPS,
    MOST_WEIGHT,
    SUFFIX_DECIDES,
    UNTIL_STOPPED,
    Cost,
    RegionKind,
)
from mission.spec.motion import MOTION, NODE_MOTIONS
from mission.spec.shape_schema import (
    AREA_SHAPES,
    AREAS,
    GO_TOGETHER,
    ORIGIN,
    POINT,
    POINT_REFERENCE,
    RING,
    Schema,
    mapping,
    number,
    one_of,
)
from mission.spec.task_schema import REGION_NAME, TASK, TASKS
from mission.spec.written_automaton import SCHEMA as AUTOMATON

MOST_REGIONS: Final = 1_000
LATEST_S: Final = 86_400.0
"""No region comes or goes later, s after the trajectory begins."""

REGION_NAME_PATTERN: Final = r'^[^"\\\s\x00-\x1f\x7f]([^"\\\x00-\x1f\x7f]*[^"\\\s\x00-\x1f\x7f])?$'
"""Any letters, and spaces inside: what a formula can name, in quotes where it is not made of A to Z, digits and _."""
OPERATOR_NAMES: Final = "^([FGX]+|U|W|M|V|true|false|xor)$"
"""Names that a region may not have: operators and constants. R is one, too, but the paper's home has that name, and no
formula can mean both by it, for the operator stands after an operand and the region never does."""


def _clearance(description: str, **more: Any) -> Schema:  # noqa: ANN401 - any JSON value
    return number(description, 0.0, 1_000.0, **more)


_MESH: Final = mapping(
    "How fine the mesh of a boundary is. Its points are placed by the program; outlines may cross each other and the "
    "boundary, and are joined where they nearly meet.",
    (),
    {
        "smallest_angle_deg": number(
            "No angle of a triangle is smaller, but where the outlines have one.", 1.0, 28.0, default=20.0
        ),
        "largest_m": number(
            "No edge is longer, m; without it, edges are as long as angles allow.", 0.01, 1.0e6, examples=[20.0]
        ),
    },
    examples=[{"smallest_angle_deg": 20.0}, {"largest_m": 15.0}],
)

_DOMAIN: Final = mapping(
    "Where the vehicle may fly: nodes, or a boundary.",
    (),
    {
        "nodes": {
            "description": "Points whose convex hull is the domain; its Delaunay triangulation is the mesh. "
            "Regions name nodes by their number, from 0.",
            "type": "array",
            "items": POINT_REFERENCE,
            "minItems": 3,
            "maxItems": 100_000,
            "examples": [[[0, 0], [20, 0], [20, 10]]],
        },
        "boundary": {
            "description": "Corners of a simple polygon, in order, which need not be convex and is closed by itself; "
            "or a shape with the keys of a region's.",
            "anyOf": [
                RING,
                mapping("A shape.", (), AREA_SHAPES, oneOf=one_of(*AREAS), **GO_TOGETHER),
            ],
            "examples": [[[0, 0], [20, 0], [20, 10]]],
        },
        "clearance_m": _clearance("How far to keep from the boundary, m.", default=0.0),
        "restricted_clearance_m": _clearance(
            "How far to keep from restricted regions that have no `clearance_m` of their own, m.", default=0.0
        ),
        "mesh": _MESH,
        "motions": NODE_MOTIONS,
        "corners": {
            "description": "What all points of the file are: [east, north] in metres, or [latitude, longitude] in "
            "degrees (WGS 84), within 50 km of the origin, which is the middle of the domain where there is none.",
            "enum": ["metres", "latitude_longitude"],
            "default": "metres",
        },
    },
    oneOf=one_of("nodes", "boundary"),
    dependentRequired={
        **{key: ["boundary"] for key in ("mesh", "clearance_m", "restricted_clearance_m")},
        "motions": ["nodes"],
    },
    examples=[{"boundary": [[0, 0], [150, 0], [150, 100], [0, 100]]}],
)

NEEDLESS_KEYS: Final = {("domain", "points"): "the mesh places its own points"}
"""Keys that somebody may expect, and why there are none: whoever has one is told to delete it."""

_REGION: Final = mapping(
    "A named part of the domain: one triangle of the mesh, or an area of several.",
    ("kind",),
    {
        "kind": {
            "description": "survey: a place to visit; home: where to end; restricted: never entered, "
            "whatever the formula says; area: neither, a place that has a name.",
            "enum": [kind.value for kind in RegionKind],
        },
        "triangle": {
            "description": "The triangle with these three vertices of the mesh, by number from 0, in any order.",
            "type": "array",
            "items": {"type": "integer", "minimum": 0, "maximum": 1_000_000},
            "minItems": 3,
            "maxItems": 3,
            "uniqueItems": True,
            "examples": [[7, 4, 1]],
        },
        "at": POINT | {"description": "The triangle with this point inside."},
        **AREA_SHAPES,
        "clearance_m": _clearance(
            "By how much a restricted region is larger than it is drawn, or another one smaller, m; without it that is "
            "`restricted_clearance_m` of the domain, or 0.",
            examples=[3.0],
        ),
        "loiter_s": number(
            "How long to stand still on entering the region, s; to start inside is not to enter.",
            0.0,
            86_400.0,
            default=0.0,
        ),
        "speed_m_s": number("Largest speed while any of the tube is inside, m/s.", 0.001, 100.0, examples=[2.0]),
        "cover": COVER,
        "active_s": {
            "description": "From when to when the region is there, s after the trajectory begins, both included; null "
            "for an end that is open. At other times it is as if it were not drawn.",
            "type": "array",
            "items": {
                "anyOf": [{"const": None}, {"type": "number", "minimum": 0.0, "maximum": LATEST_S}],
            },
            "minItems": 2,
            "maxItems": 2,
            "examples": [[60, 180]],
        },
        "motion": MOTION,
    },
    oneOf=one_of("triangle", "at", *AREAS),
    **GO_TOGETHER,
    examples=[{"kind": "survey", "at": [12.5, 40.0]}],
)

SHAPE_KEYS: Final = ("triangle", "at", *AREA_SHAPES, "clearance_m")
"""The keys of a region that say where it is."""
DOMAIN_KEYS: Final = tuple(_DOMAIN["properties"])

_REGIONS: Final[Schema] = {
    "description": "The regions by name. A formula speaks of them by these names.",
    "type": "object",
    "minProperties": 1,
    "maxProperties": MOST_REGIONS,
    "propertyNames": {
        "pattern": REGION_NAME_PATTERN,
        "maxLength": 60,
        "not": {"pattern": OPERATOR_NAMES},
    },
    "additionalProperties": {"$ref": "#/$defs/region"},
    "examples": [{"Field": {"kind": "survey", "at": [12.5, 40.0]}}],
}

_FORMULAS: Final = ["F (S1 & F Home) & G !K1"]
_MISSIONS: Final = [{"formula": "F S1 & G !K1"}]

_MISSION: Final = mapping(
    "What must be true of the flight.",
    (),
    {
        "formula": {
            "description": "A formula of linear temporal logic over the region names: F G X U R W M ! & | -> <->.",
            "type": "string",
            "minLength": 1,
            "maxLength": MAX_LENGTH,
            "examples": _FORMULAS,
        },
        "automaton": {
            "description": "Instead of a formula, a file with a Büchi automaton in the Hanoi Omega-Automata format: "
            "its path, relative to this file. Its propositions are region names. Or the automaton itself.",
            "anyOf": [{"type": "string", "minLength": 1, "maxLength": 1_000}, AUTOMATON],
            "examples": ["pairs.hoa"],
        },
        "semantics": {
            "description": "Whether the start's own region is read by the formula (standard) or not (paper).",
            "enum": ["standard", "paper"],
            "default": "standard",
        },
        "run": {
            "description": "Which of the shortest runs to fly, from 0.",
            "type": "integer",
            "minimum": 0,
            "maximum": 10**30,
            "default": 0,
        },
        "laps": {
            "description": "How often the loop of a recurrent mission is flown before the vehicle returns; "
            "until_stopped: until Ctrl-C is pressed.",
            "anyOf": [{"type": "integer", "minimum": 1, "maximum": MOST_LAPS}, {"const": UNTIL_STOPPED}],
            "default": 2,
            "examples": [2, UNTIL_STOPPED],
        },
    },
    **{"not": {"required": ["formula", "automaton"]}},
    examples=_MISSIONS,
)

_START: Final = mapping(
    "Where the flight begins, and how fast.",
    ("position_m",),
    {
        "position_m": {"$ref": "#/$defs/point"},
        "velocity_m_s": {
            "description": "[east, north] in m/s: the rest of the paper's start state. A vehicle that takes off on "
            "the spot starts at rest, so it changes neither the plan nor the flight.",
            "type": "array",
            "items": {"type": "number", "minimum": -100.0, "maximum": 100.0},
            "minItems": 2,
            "maxItems": 2,
            "default": [0.0, 0.0],
        },
    },
    examples=[{"position_m": [12.5, 40.0]}],
)


def _weight(part: str, default: int | str) -> Schema:
    whole = {"type": "integer", "minimum": 1, "maximum": MOST_WEIGHT}
    if default == SUFFIX_DECIDES:
        return {
            "description": f"How much a unit of the {part} weighs; decides: the {part} is made best first, "
            "and only what leads to it is chosen by cost.",
            "anyOf": [whole, {"const": SUFFIX_DECIDES}],
            "default": default,
            "examples": [SUFFIX_DECIDES, 10],
        }
    return {"description": f"How much a unit of the {part} weighs.", "default": default} | whole


_SEARCH: Final = mapping(
    "Which runs are best: those with the least cost.",
    (),
    {
        "cost": {
            "description": "What is counted: the transitions between triangles, the metres of the way, or the seconds "
            "that it takes with its stops. Metres and seconds do not depend on the mesh. By metres lanes have the "
            "heading and the order that are shortest, otherwise those that are fastest. Without it seconds count where "
            "a region is covered, metres elsewhere.",
            "enum": [cost.value for cost in Cost],
        },
        "prefix_weight": _weight("prefix, which is flown once,", 1),
        "suffix_weight": _weight("suffix, which is repeated,", SUFFIX_DECIDES),
    },
    examples=[{"cost": "distance"}],
)

_SERIES: Final = mapping(
    "The Fourier series that smooths the path of the fields.",
    (),
    {
        "extension": {
            "description": "odd keeps both end points; even is the paper's. Laps must join: they are odd.",
            "enum": ["odd", "even"],
            "default": "odd",
        },
        "frequencies": {
            "description": "How many; auto takes as few as the proof needs.",
            "anyOf": [{"const": "auto"}, {"type": "integer", "minimum": 1, "maximum": 10_000}],
            "default": "auto",
            "examples": ["auto", 28],
        },
    },
    examples=[{"extension": "odd", "frequencies": "auto"}],
)

_SMOOTHING: Final[Schema] = {
    "description": "How a run becomes a curve: in the corridor of the shortest path, or by the Fourier series of the "
    "path of the fields, as the paper has it.",
    "anyOf": [_SERIES, {"type": "string", "enum": [CORRIDOR]}],
    "default": CORRIDOR,
    "examples": [CORRIDOR, {"extension": "odd", "frequencies": "auto"}],
}

_LIMITS: Final = mapping(
    "What the vehicle can do; the trajectory slows down where it would exceed them.",
    (),
    {
        "speed_m_s": number("Largest horizontal speed, m/s.", 0.001, 100.0, default=5.0),
        "acceleration_m_s2": number("Largest horizontal acceleration, m/s2.", 0.001, 50.0, default=2.5),
        "jerk_m_s3": number(
            "Largest horizontal jerk, m/s3: how fast the acceleration may change.", 0.01, 1000.0, default=4.0
        ),
        "tilt_deg": number("Largest tilt, degrees.", 1.0, 80.0, default=25.0),
        "yaw_rate_deg_s": YAW_RATE_SCHEMA,
    },
    examples=[{"speed_m_s": 5.0, "acceleration_m_s2": 2.5, "tilt_deg": 25.0}],
)

_SCHEMA: Final[Schema] = {
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "title": "Mission file of ltl-mission",
    "$defs": {"point": POINT, "region": _REGION, "task": TASK, "region_name": REGION_NAME},
} | mapping(
    "A drone mission written in linear temporal logic. ENU; units stand in the names of the keys.",
    ("domain", "regions", "start"),
    {
        "name": {
            "description": "Name of the mission; without it, the file's name.",
            "type": "string",
            "minLength": 1,
            "maxLength": 200,
            "examples": ["Survey of the north field"],
        },
        "description": {
            "description": "For people.",
            "type": "string",
            "maxLength": 10_000,
            "default": "",
            "examples": ["Visits the north field, then goes home."],
        },
        "domain": _DOMAIN,
        "regions": _REGIONS,
        "mission": _MISSION,
        "tasks": TASKS,
        "start": _START,
        "origin": ORIGIN,
        "flight": FLIGHT,
        "search": _SEARCH,
        "smoothing": _SMOOTHING,
        "limits": _LIMITS,
        "battery": BATTERY_SCHEMA,
    },
    **{
        # Without tasks there must be a formula or an automaton.
        "if": {"not": {"required": ["tasks"]}},
        "then": {
            "required": ["mission"],
            "properties": {
                "mission": {
                    "if": {"not": {"required": ["automaton"]}},
                    "then": {"required": ["formula"], "properties": {"formula": {"examples": _FORMULAS}}},
                    "examples": _MISSIONS,
                }
            },
        },
    },
)


def mission_schema() -> Schema:
    """The JSON Schema of mission files, a copy of one's own."""
    return deepcopy(_SCHEMA)


def default_of(section: str, key: str) -> Any:  # noqa: ANN401 - any JSON value
    """The default of ``section.key``, such as ``flight.speed_m_s``."""
    return deepcopy(keys_of(_SCHEMA["properties"][section])[key]["default"])


def keys_of(schema: Schema) -> Schema:
    """The keys of a mapping, or of the one that is among the shapes a value may have, each with its schema."""
    shapes = [schema, *schema.get("anyOf", [])]
    return next((shape["properties"] for shape in shapes if "properties" in shape), {})
