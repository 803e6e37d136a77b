"""The structure of ``tasks``, as JSON Schema."""

from collections.abc import Mapping
from typing import Any, Final

from mission.spec.task import BOUND_KEYS, BY, EVERY, WITHIN, TaskKind

Schema = dict[str, Any]

MOST_TASKS: Final = 50
MOST_SOFT_TASKS: Final = 12
"""As many tasks may carry a weight: which of them to drop is found exactly, among all their subsets."""

REGION_NAME: Final[Schema] = {
    "description": "The name of a region.",
    "type": "string",
    "minLength": 1,
    "maxLength": 60,
    "examples": ["S1"],
}

_NAME: Final[Schema] = {"$ref": "#/$defs/region_name"}


def _regions(description: str, *, least: int = 1, most: int = 12, unique: bool = True) -> Schema:
    names = ["S1", "S2", "home"]
    return {
        "description": description,
        "type": "array",
        "items": _NAME,
        "minItems": least,
        "maxItems": most,
        "uniqueItems": unique,
        "examples": [names[: max(least, 2)]],
    }


def _pair(description: str, first: str, second: str, **more: Schema) -> Schema:
    """A mapping of two region names."""
    return {
        "description": description,
        "type": "object",
        "additionalProperties": False,
        "required": [first, second],
        "properties": {first: _NAME, second: _NAME, **more},
        "examples": [{first: "S1", second: "S2"}],
    }


def _one_or_more(description: str) -> Schema:
    return {"description": description, "anyOf": [_NAME, _regions(description)], "examples": [["S1", "S2"], "S1"]}


_AVOID: Final[Schema] = {
    "description": "Regions that are never entered; or {region, until} or {region, after} for one that is not entered "
    "until another is (which must be), or never after it.",
    "anyOf": [
        _NAME,
        _regions("Regions that are never entered."),
        {
            "description": "A region and from when or until when it is not entered.",
            "type": "object",
            "additionalProperties": False,
            "required": ["region"],
            "properties": {"region": _NAME, "until": _NAME, "after": _NAME},
            "oneOf": [{"required": ["until"]}, {"required": ["after"]}],
            "examples": [{"region": "K1", "until": "S1"}],
        },
    ],
    "examples": ["K1", ["K1", "K2"], {"region": "K1", "until": "S1"}, {"region": "K1", "after": "S1"}],
}

_COUNT: Final[Schema] = {
    "description": "A number of visits.",
    "type": "integer",
    "minimum": 1,
    "maximum": 12,
    "examples": [2],
}

_VISITS: Final[Schema] = {
    "description": "How often a region is visited; a visit lasts until the vehicle comes to another region.",
    "type": "object",
    "additionalProperties": False,
    "required": ["region"],
    "properties": {"region": _NAME, "at_least": _COUNT, "at_most": _COUNT, "exactly": _COUNT},
    "oneOf": [{"required": [bound]} for bound in ("at_least", "at_most", "exactly")],
    "examples": [{"region": "S1", "at_most": 2}],
}

_HOW: Final[Schema] = {
    "description": "instantaneous: at the same time; delayed: later; prompt: before any other region; bound: at the "
    "same time, and only then; bound_delay: before any other region, and only then.",
    "enum": ["instantaneous", "delayed", "prompt", "bound", "bound_delay"],
    "default": "delayed",
}

_KINDS: Final[Schema] = {
    "visit": _one_or_more("Every one is visited, in any order."),
    "sequenced_visit": _regions("A visit to each comes after one to the region before it.", least=2, unique=False),
    "ordered_visit": _regions("As sequenced, and none is visited before the region before it.", least=2),
    "strict_ordered_visit": _regions("As ordered, and each is visited once only before the next is.", least=2),
    "fair_visit": _regions("Every one is visited, none again before all the others.", least=2, most=4),
    "patrol": _one_or_more("Every one is visited again and again."),
    "sequenced_patrol": _regions("The sequence is flown again and again, whatever else is visited.", least=2),
    "ordered_patrol": _regions("As patrol, and none is visited (again) before the region before it.", least=2, most=5),
    "strict_ordered_patrol": _regions("Visited in exactly this order, round after round.", least=2, most=5),
    "fair_patrol": _regions("Visited again and again, none again before all the others.", least=2, most=4),
    "avoid": _AVOID,
    "visits": _VISITS,
    "wait": _pair("The vehicle stays in a region from the start until it enters another.", "in", "until"),
    "react": _pair("Whenever in one region (when), then in the other.", "when", "then", how=_HOW),
}

_BOUNDS: Final[Mapping[str, str]] = {
    BY: "It is done so many seconds after the trajectory begins, at most",
    WITHIN: "The reaction comes so many seconds after each moment of its trigger, at most",
    EVERY: "Each region is visited again after so many seconds, at most, once it has been: lap after lap",
}


def _bound(key: str) -> Schema:
    kinds = ", ".join(kind.value for kind, of_kind in BOUND_KEYS.items() if of_kind == key)
    return {
        "description": f"{_BOUNDS[key]}; of {kinds}.",
        "type": "number",
        "minimum": 0.001,
        "maximum": 100_000.0,
        "examples": [120],
    }


TASK: Final[Schema] = {
    "description": "What is to be done: one kind of task, and a weight where it may be dropped.",
    "type": "object",
    "additionalProperties": False,
    "properties": _KINDS
    | {key: _bound(key) for key in _BOUNDS}
    | {
        "weight": {
            "description": "Makes the task soft: where not all can be met, those of the least total weight are "
            "dropped.",
            "type": "number",
            "minimum": 0.001,
            "maximum": 1_000_000.0,
            "examples": [2],
        }
    },
    "oneOf": [{"required": [kind.value]} for kind in TaskKind],
    "examples": [{"visit": ["S1", "S2"]}],
}

TASKS: Final[Schema] = {
    "description": "What must be true of the flight, without a formula; all of them, and the formula where one is "
    "given.",
    "type": "array",
    "items": {"$ref": "#/$defs/task"},
    "minItems": 1,
    "maxItems": MOST_TASKS,
    "examples": [[{"visit": ["S1", "S2"]}, {"avoid": "K1"}, {"visit": ["S3"], "weight": 2}]],
}
