"""The tables of keys: every key that the loader takes, with a unit, a default and an example that fits it."""

import re
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from mission.spec.key_tables import OF_POINTS, UNITS, Key, keys, tables
from mission.spec.schema import mission_schema

ALL = list(keys())


def named(schema: Any) -> set[str]:  # noqa: ANN401 - any part of a schema
    """Every key that stands anywhere in a schema."""
    if isinstance(schema, list):
        return set().union(*map(named, schema))
    if not isinstance(schema, dict):
        return set()
    below = {key for properties in [schema.get("properties")] if isinstance(properties, dict) for key in properties}
    return below.union(*map(named, schema.values()))


def test_no_key_is_left_out() -> None:
    assert {key.path.rpartition(".")[2] for key in ALL} == named(mission_schema())
    paths = [key.path for key in ALL]
    assert len(set(paths)) == len(paths)


@pytest.mark.parametrize("key", ALL, ids=lambda key: key.path)
def test_its_example_and_its_default_fit(key: Key) -> None:
    schema = {"$defs": mission_schema()["$defs"], **key.schema}
    values = [key.example, *([key.schema["default"]] if "default" in key.schema else [])]
    for value in values:
        Draft202012Validator(schema).validate(value)
    assert key.schema["description"].endswith((".", ")"))


def test_a_number_with_a_dimension_has_its_unit() -> None:
    plain = {"weight", "overlap", "sidelap", "share", "reserve"}
    for key in ALL:
        assert key.schema.get("type") != "number" or key.unit or key.path.rpartition(".")[2] in plain, key.path
    by_path = {key.path: key for key in ALL}
    assert by_path["limits.jerk_m_s3"].unit == "m/s³"
    assert by_path["limits.yaw_rate_deg_s"].unit == "degrees/s"
    assert by_path["mission.laps"].unit == ""
    assert by_path["regions.NAME.holes"].unit == by_path["start.position_m"].unit == OF_POINTS
    assert {*UNITS.values(), OF_POINTS} == {key.unit for key in ALL if key.unit}


def test_a_row_has_all_of_it() -> None:
    rows = {row.split("`")[1]: row for row in tables().splitlines() if row.startswith("| `")}
    assert list(rows) == [key.path for key in ALL]
    assert rows["flight.altitude_m"].startswith("| `flight.altitude_m` | m | `10.0` | `10.0` | Height above")
    assert rows["start.position_m"].split(" | ")[2] == "required"
    assert r"& \| -> <->" in rows["mission.formula"]
    assert all(len(re.split(r"(?<!\\)\|", row)) == 7 for row in rows.values())
