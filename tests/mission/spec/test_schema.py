"""The schema is one, says what each key is for, and agrees with itself."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml
from jsonschema import Draft202012Validator

from mission.spec.schema import default_of, mission_schema

MISSIONS = Path(__file__).parents[3] / "missions"


def schemas(schema: dict[str, Any], path: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Every subschema of a key, with its path."""
    for name, value in schema.get("properties", {}).items():
        yield f"{path}.{name}", value
        yield from schemas(value, f"{path}.{name}")
    for name, value in schema.get("$defs", {}).items():
        yield from schemas(value, f"${name}")


def test_it_is_a_schema_of_its_draft() -> None:
    schema = mission_schema()
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    Draft202012Validator.check_schema(schema)


def test_every_key_is_described() -> None:
    for path, schema in schemas(mission_schema()):
        assert "description" in schema or "$ref" in schema, path


def test_defaults_and_examples_fit_their_own_schemas() -> None:
    whole = mission_schema()
    count = 0
    for path, schema in schemas(whole):
        validator = Draft202012Validator({**schema, "$defs": whole["$defs"]})
        for value in [*schema.get("examples", []), *([schema["default"]] if "default" in schema else [])]:
            assert not list(validator.iter_errors(value)), path
            count += 1
    assert count > 30


def test_an_editor_accepts_the_papers_mission() -> None:
    data = yaml.safe_load((MISSIONS / "paper.yaml").read_text(encoding="utf-8"))
    assert Draft202012Validator(mission_schema()).is_valid(data)


def test_the_schema_is_ones_own_copy() -> None:
    mission_schema()["properties"].clear()
    default_of("start", "velocity_m_s").append(1.0)
    assert mission_schema()["properties"]
    assert default_of("start", "velocity_m_s") == [0.0, 0.0]
