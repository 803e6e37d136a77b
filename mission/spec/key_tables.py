"""Every key of a mission file for people, as tables in Markdown, from the schema alone."""

import json
from collections.abc import Iterator
from typing import Any, Final, NamedTuple

from mission.spec.schema import mission_schema
from mission.spec.shape_schema import COORDINATE, POINT_REFERENCE, Schema

UNITS: Final = {
    "_m_s3": "m/s³",
    "_m_s2": "m/s²",
    "_m_s": "m/s",
    "_deg_s": "degrees/s",
    "_deg": "degrees",
    "_mm": "mm",
    "_mah": "mAh",
    "_a": "A",
    "_m": "m",
    "_s": "s",
    ".fixed": "degrees",
}
"""Units by the ends of keys; the first that fits counts."""

OF_POINTS: Final = "m, or degrees"
"""Of what is made of points: ``domain.corners`` says which."""

_HEAD: Final = ("| key | unit | default | example | what it says |", "|---|---|---|---|---|")


class Key(NamedTuple):
    """A key of a mission file.

    Attributes:
        path: With its sections; ``NAME`` stands for a name of one's own, ``[]`` for any item of a list.
        required: Whether it must be there where its section is.
        schema: What is under it, without references.
    """

    path: str
    required: bool
    schema: Schema

    @property
    def unit(self) -> str:
        """The unit of its value; empty where it has none."""
        if _is_of_points(self.schema):
            return OF_POINTS
        return next((unit for end, unit in UNITS.items() if self.path.endswith(end)), "")

    @property
    def example(self) -> Any:  # noqa: ANN401 - any JSON value
        """A value that it may have.

        Raises:
            KeyError: The schema has neither an example nor a default of it, nor a choice.
        """
        examples = self.schema.get("examples") or self.schema.get("enum")
        return examples[0] if examples else self.schema["default"]


def keys() -> Iterator[Key]:
    """Every key, each section before its keys."""
    schema = mission_schema()
    return _keys("", schema, schema["$defs"])


def tables() -> str:
    """The keys as Markdown, a table for each key of the top level."""
    lines: list[str] = []
    for key in keys():
        if "." not in key.path.replace("[]", "."):
            lines += [f"\n### `{key.path}`\n", *_HEAD]
        default = "required" if key.required else _code(key.schema["default"]) if "default" in key.schema else ""
        cells = (f"`{key.path}`", key.unit, default, _code(key.example), key.schema.get("description", ""))
        lines.append(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |")
    return "\n".join(lines).strip() + "\n"


def _keys(path: str, schema: Schema, definitions: Schema) -> Iterator[Key]:
    for shape in (schema, *schema.get("anyOf", ()), *schema.get("oneOf", ())):
        known = _resolved(shape, definitions)
        for name, below in known.get("properties", {}).items():
            key = Key(f"{path}.{name}".strip("."), name in known.get("required", ()), _resolved(below, definitions))
            yield key
            yield from _keys(key.path, key.schema, definitions)
        for end, kind in ((".NAME", "additionalProperties"), ("[]", "items")):
            if isinstance(known.get(kind), dict):
                yield from _keys(path + end, _resolved(known[kind], definitions), definitions)


def _resolved(schema: Schema, definitions: Schema) -> Schema:
    """The schema with what it refers to; what it says itself goes before that."""
    if "$ref" not in schema:
        return schema
    named = definitions[schema["$ref"].rpartition("/")[2]]
    return _resolved(named, definitions) | {key: value for key, value in schema.items() if key != "$ref"}


def _is_of_points(schema: Schema) -> bool:
    """Whether a value is a point, or a list of points, or one of lists of them."""
    if schema.get("$ref") == POINT_REFERENCE["$ref"] or schema.get("items") == COORDINATE:
        return True
    return any(map(_is_of_points, (*schema.get("anyOf", ()), *([schema["items"]] if "items" in schema else []))))


def _code(value: Any) -> str:  # noqa: ANN401 - any JSON value
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return f"`{text}`" if text else "empty"
