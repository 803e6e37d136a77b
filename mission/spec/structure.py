"""The tree of a mission file against the schema: plain data, and findings in words that say what to write."""

import json
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from itertools import islice
from typing import Any, Final

from jsonschema import Draft202012Validator
from jsonschema.exceptions import ValidationError
from jsonschema.validators import extend

from mission.decimals import decimal
from mission.spec.finding import Finding, Path, dotted, listed, nearest, shortened
from mission.spec.geography import far_from_origin
from mission.spec.nodes import Mapping, Node, Scalar, Sequence, Table
from mission.spec.scalars import Oddity, number_hint, plain_value
from mission.spec.schema import NEEDLESS_KEYS, keys_of, mission_schema
from mission.spec.shape_schema import MAX_COORDINATE_M, POINT_REFERENCE, Schema
from mission.spec.task import BY, EVERY, WITHIN

MOST_ERRORS: Final = 1_000

_KINDS: Final = {
    "object": "a mapping of keys to values",
    "array": "a list",
    "string": "text",
    "number": "a number",
    "integer": "a whole number",
}
_PYTHON_TYPES: Final = {"object": dict, "array": list, "string": str}
_TASK_DEPTH: Final = 2


def _items(validator: Any, items: Schema, instance: Any, schema: Schema) -> Iterable[ValidationError]:  # noqa: ANN401 - as jsonschema calls it
    """The keyword ``items``; of a list of points, only those are gone through that do not fit."""
    if items != POINT_REFERENCE or not isinstance(instance, list):
        yield from Draft202012Validator.VALIDATORS["items"](validator, items, instance, schema)
        return
    for index, point in enumerate(instance):
        if not _is_point(point):
            yield from validator.descend(point, items, path=index)


def _is_point(value: Any) -> bool:  # noqa: ANN401 - any JSON value
    """Whether a value fits the schema of points, as far as that is plain to see."""
    return (
        type(value) is list
        and len(value) == 2  # noqa: PLR2004 - the plane
        and all(type(x) in (int, float) and -MAX_COORDINATE_M <= x <= MAX_COORDINATE_M for x in value)
    )


_Validator: Final = extend(Draft202012Validator, {"items": _items})  # type: ignore[no-untyped-call]


@cache
def _validator() -> Any:  # noqa: ANN401 - of a class made at run time
    return _Validator(mission_schema())


def plain_data(tree: Node) -> tuple[Any, list[Finding]]:
    """The tree as dicts, lists and scalars (``Oddity`` where YAML reads a plain scalar as something unwanted).

    Keys that YAML does not read as text are findings.
    """
    findings: list[Finding] = []
    return _plain(tree, (), findings), findings


def _plain(node: Node, path: Path, findings: list[Finding]) -> Any:  # noqa: ANN401 - any JSON value
    # Recursion is safe: the tree's depth is bounded (yaml_tree.MAX_DEPTH).
    if isinstance(node, Scalar):
        return plain_value(node.text) if node.plain else node.text
    if isinstance(node, Table):
        return node.rows
    if isinstance(node, Sequence):
        return [_plain(item, (*path, i), findings) for i, item in enumerate(node.items)]
    for name, key in node.keys.items():
        value = plain_value(name) if key.plain else name
        if not isinstance(value, str):
            message = f"YAML does not read the key `{shortened(name)}` as text"
            findings.append(Finding((*path, name), message, "choose another name, or put it in quotes", at_key=True))
    return {name: _plain(value, (*path, name), findings) for name, value in node.values.items()}


_OF_DRAWINGS: Final = "of what other programs have drawn, `mission new --from FILE` makes a mission file"
_DRAWN_KEYS: Final = {"features", "geometry", "coordinates", "fileType"}
"""Keys of GeoJSON and of ground stations' plans, at the top."""


def structure_findings(data: Any, tree: Node) -> list[Finding]:  # noqa: ANN401 - any JSON value
    """Everything in which the data departs from the schema, as far as the first ``MOST_ERRORS`` of the validator."""
    if _DRAWN_KEYS & (data.keys() if isinstance(data, dict) else set()):
        return [Finding((), "this is not a mission file, but what another program has drawn", _OF_DRAWINGS)]
    far = far_from_origin(data)
    findings: list[Finding] = [far] if far else []
    for error in islice(_validator().iter_errors(data), MOST_ERRORS):
        findings.extend(_worded(error, tree))
    return list(dict.fromkeys(findings))


def _worded(error: ValidationError, tree: Node) -> Iterable[Finding]:
    """The findings that one error of the validator stands for."""
    path: Path = tuple(error.absolute_path)
    keyword, limit, instance, schema = _parts(error)
    if keyword == "additionalProperties":
        yield from _unknown_keys(path, instance, schema)
    elif keyword == "required":
        yield from _missing_keys(path, instance, schema)
    elif keyword == "oneOf" or (keyword == "not" and "required" in limit):
        # What is no mapping lacks no key, says the schema: its type is the fault, and is reported.
        if isinstance(instance, dict):
            yield from _alternatives(path, instance, limit if keyword == "oneOf" else _each(limit["required"]))
    elif keyword == "anyOf" and not any("const" in option for option in limit):
        yield from _of_its_kind(error, tree)
    elif keyword == "dependentRequired":
        for key in sorted(limit.keys() & instance.keys()):
            message = f"`{key}` goes with `{listed(limit[key])}` only"
            yield Finding((*path, key), message, f"take it away, or give `{listed(limit[key])}`", at_key=True)
    elif "propertyNames" in error.absolute_schema_path:
        yield _region_name((*path, instance), instance)
    elif keyword in ("type", "enum", "anyOf"):
        yield _wrong_kind(path, instance, schema, tree)
    else:
        yield Finding(path, *_out_of_bounds(keyword, limit, instance, schema))


def _parts(error: ValidationError) -> tuple[str, Any, Any, Schema]:
    """Keyword, its value, the instance and the schema of an error, each of which the library may leave unset."""
    return str(error.validator), error.validator_value, error.instance, dict(error.schema)  # type: ignore[arg-type]


def _unknown_keys(path: Path, instance: dict[str, Any], schema: Schema) -> Iterable[Finding]:
    known = schema["properties"]
    for key in instance.keys() - known.keys():
        if key == "<<":
            yield Finding((*path, key), "merge keys are not allowed", "write the keys out", at_key=True)
            continue
        needless = NEEDLESS_KEYS.get((*path, key))
        if needless:
            yield Finding((*path, key), f"`{key}` is no key of `{dotted(path)}`: {needless}", "delete it", at_key=True)
            continue
        close, elsewhere = nearest(key, known), _places_of(key)
        hint = f"did you mean `{close}`?" if close else f"known keys here: {listed(known)}"
        if elsewhere:
            hint = f"it belongs {' or '.join(elsewhere)}"
        yield Finding((*path, key), f"unknown key `{shortened(key)}`", hint, at_key=True)


def _places_of(key: str) -> list[str]:
    """Where in the file a key of this name stands: at its top, or in one of the mappings there."""
    top = mission_schema()["properties"]
    within = [f"in `{section}`" for section, schema in top.items() if key in keys_of(schema)]
    return ["at the top of the file"] * (key in top) + within


def _missing_keys(path: Path, instance: dict[str, Any], schema: Schema) -> Iterable[Finding]:
    for key in schema["required"]:
        if key not in instance:
            example = _example(schema["properties"][key])
            where = f" in `{dotted(path)}`" if path else ""
            instead = {"mission": ", or give tasks", "formula": ", or name an automaton, or give tasks"}.get(key, "")
            yield Finding((*path, key), f"`{key}` is missing{where}", f"add {key}: {example}{instead}", at_key=True)


def _each(keys: list[str]) -> list[Schema]:
    return [{"required": [key]} for key in keys]


def _alternatives(path: Path, instance: dict[str, Any], options: list[Schema]) -> Iterable[Finding]:
    keys = [option["required"][0] for option in options]
    given = [key for key in keys if key in instance]
    wanted = " or ".join((", ".join(keys[:-1]), keys[-1]))
    whole_task = path[:1] == ("tasks",) and len(path) == _TASK_DEPTH
    if given:
        hint = "make a task of each" if whole_task else f"keep one of {wanted}"
        yield Finding(path, f"{' and '.join(given)} exclude each other", hint, at_key=True)
    elif whole_task:
        # An unknown key in a task is most likely the one that is missing, misspelt; it is reported.
        if instance.keys() <= {"weight", BY, WITHIN, EVERY}:
            yield Finding(path, "a task is missing here", f"give one of {wanted}", at_key=True)
    elif path[:1] != ("tasks",) or instance.keys() <= {"region"}:
        yield Finding(path, f"one of {wanted} is missing in `{dotted(path)}`", "give exactly one of them", at_key=True)


def _of_its_kind(error: ValidationError, tree: Node) -> Iterable[Finding]:
    """What is wrong with a value of several possible shapes, by the shape that it has."""
    path: Path = tuple(error.absolute_path)
    _, options, instance, schema = _parts(error)
    shapes = [_resolved(option)["type"] for option in options]
    own = next((i for i, shape in enumerate(shapes) if isinstance(instance, _PYTHON_TYPES[shape])), None)
    if own is None or isinstance(instance, Oddity):
        expected = " or ".join(_KINDS[shape] for shape in shapes)
        found = instance.found if isinstance(instance, Oddity) else _found(instance, _at(tree, path))
        yield Finding(path, f"expected {expected}, found {found}", f"write for example {_examples(schema)}")
        return
    for inner in error.context or ():
        if inner.schema_path[0] == own:
            for finding in _worded(inner, tree):
                # Of a value as a whole that is like none, all that it may be is shown, whatever shape it has.
                unlike = inner.validator == "enum" and finding.hint.startswith(_FOR_EXAMPLE)
                yield replace(finding, hint=f"{_FOR_EXAMPLE}{_examples(schema)}") if unlike else finding


def _region_name(path: Path, name: str) -> Finding:
    message = f"`{shortened(name)}` cannot name a region"
    hint = (
        "60 characters at most, no quotes, backslashes, spaces at the ends; not F, G, X, U, W, M, V, true, false, xor"
    )
    return Finding(path, message, hint, at_key=True)


def _wrong_kind(path: Path, instance: Any, schema: Schema, tree: Node) -> Finding:  # noqa: ANN401 - any JSON value
    example = _example(schema)
    options = schema.get("enum") or [o["const"] for o in schema.get("anyOf", []) if "const" in o]
    if options:
        expected = f"one of {listed(options)}" if "enum" in schema else _name_or_number(options[0], schema)
        texts = [option for option in options if isinstance(option, str)]
        close = nearest(instance, texts) if isinstance(instance, str) else ""
        hint = f"did you mean `{close}`?" if close else f"{_FOR_EXAMPLE}{_flow(options[0])}"
    else:
        expected = _KINDS[schema["type"]]
        keys = schema.get("properties", {})
        hint = f"write for example {example}" if example else f"its keys are {listed(keys)}" if keys else ""
    node = _at(tree, path)
    if not path and isinstance(instance, str) and instance.startswith("<"):
        hint = _OF_DRAWINGS
    if isinstance(instance, Oddity):
        return Finding(path, f"expected {expected}, found {instance.found}", instance.hint)
    if isinstance(node, Scalar) and isinstance(instance, str) and schema.get("type") in ("number", "integer"):
        quoted = not node.plain and not isinstance(plain_value(node.text), str)
        hint = "take the quotes away" if quoted else number_hint(node.text) or hint
    if isinstance(node, Scalar) and node.plain and not isinstance(instance, str) and schema.get("type") == "string":
        hint = f'put it in quotes: "{shortened(node.text)}"' if node.text else hint
    return Finding(path, f"expected {expected}, found {_found(instance, node)}", hint)


def _name_or_number(name: str, schema: Schema) -> str:
    number = next(option for option in schema["anyOf"] if "type" in option)
    return (
        f"{_flow(name)} or {_KINDS[number['type']]} from {decimal(number['minimum'])} to {decimal(number['maximum'])}"
    )


_FOR_EXAMPLE: Final = "write for example "


def _found(instance: Any, node: Node) -> str:  # noqa: ANN401 - any JSON value
    if instance is None:
        return "nothing"
    if isinstance(instance, dict):
        return "a mapping"
    if isinstance(instance, list):
        return "a list"
    text = shortened(node.text) if isinstance(node, Scalar) else str(instance)
    return f"the text `{text}`" if isinstance(instance, str) else f"`{text}`"


def _out_of_bounds(keyword: str, limit: Any, instance: Any, schema: Schema) -> tuple[str, str]:  # noqa: ANN401 - any JSON value
    """Message and hint where the kind is right and the measure is not."""
    shown = shortened(str(instance))
    if keyword in ("minimum", "maximum"):
        side = "less" if keyword == "minimum" else "more"
        span = f"from {decimal(schema['minimum'])} to {decimal(schema['maximum'])}"
        return f"{shown} is {side} than {decimal(limit)}", f"write a number {span}"
    if keyword == "uniqueItems":
        return f"two of {shortened(_flow(instance))} are the same", "name different ones"
    if keyword == "maxLength":
        return f"the text has {len(instance)} characters, more than {limit}", "make it shorter"
    example = f"write for example {_example(schema) or '[0, 0]'}"
    if keyword == "minLength":
        return "the text is empty", example
    exact = schema.get("minItems") == schema.get("maxItems") and "minItems" in schema
    bound = "" if exact else "at least " if keyword.startswith("min") else "at most "
    return f"expected {bound}{limit} {'item' if limit == 1 else 'items'}, found {len(instance)}", example


def _example(schema: Schema) -> str:
    """An example of what a schema allows, in YAML's flow style."""
    return next(iter(_flowing(schema)), "")


def _examples(schema: Schema) -> str:
    """All examples of what a schema allows, in a sentence."""
    *others, last = _flowing(schema) or [""]
    return f"{', '.join(others)} or {last}" if others else last


def _flowing(schema: Schema) -> list[str]:
    schema = _resolved(schema)
    examples = schema.get("examples") or ([schema["default"]] if "default" in schema else schema.get("enum", []))
    return [_flow(example) for example in examples]


def _resolved(schema: Schema) -> Schema:
    while "$ref" in schema:
        schema = mission_schema()["$defs"][schema["$ref"].rpartition("/")[2]]
    return schema


def _flow(value: Any) -> str:  # noqa: ANN401 - any JSON value
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_flow(item) for item in value) + "]"
    if value is None or (isinstance(value, str) and not value.isidentifier()):
        return json.dumps(value)
    return str(value)


def _at(tree: Node, path: Path) -> Node:
    node = tree
    for step in path:
        if isinstance(node, Sequence | Table) and isinstance(step, int):
            node = node.items[step]
        elif isinstance(node, Mapping):
            node = node.values[str(step)]
    return node
