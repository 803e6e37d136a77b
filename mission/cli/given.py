"""A mission with what was given on the command line in the place of what its file says."""

from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from typing import Any

from mission.cli.changes import CHANGES, SET, dest_of
from mission.cli.mission_input import content_of, mission_in, shown
from mission.errors import Fault, SpecError
from mission.spec.amended import GONE, Key, with_values
from mission.spec.loader import beside, parse_mission
from mission.spec.model import MissionSpec
from mission.spec.structure import plain_data
from mission.spec.yaml_tree import read_tree

Given = dict[str, tuple[Key, Any]]
"""Keys and values by the options that gave them."""


def changes_of(arguments: Namespace) -> Given:
    """The key and the value of each option that was given, by how it was given.

    Raises:
        SpecError: ``--set`` has no key and value.
    """
    given: Given = {}
    for name, change in CHANGES.items():
        value = getattr(arguments, dest_of(name))
        if value is not None:
            given[name] = (change.key, list(value) if isinstance(value, tuple) else value)
    for text in arguments.set:
        key, separator, value = text.partition("=")
        if not separator or not all(key.split(".")):
            hint = "write a key with its sections, and a value: flight.altitude_m=30"
            raise SpecError((Fault(0, 0, SET, f"`{text}` is no KEY=VALUE", hint),))
        try:
            data, _ = plain_data(read_tree(value)[0])
        except SpecError as error:
            raise SpecError((Fault(0, 0, f"{SET} {key}", error.faults[0].message, error.faults[0].hint),)) from error
        given[f"{SET} {key}"] = (tuple(key.split(".")), data)
    return given


def mission_of(file: str, given: Given) -> MissionSpec:
    """A mission with what was given in the place of what the file says.

    Raises:
        SpecError: The file has faults, or what was given makes some; its source is the file.
    """
    spec = mission_in(file)
    if not given:
        return spec
    path = Path(file)
    try:
        return parse_mission(text_with(spec, path, given).encode(), shown(file), beside(path))
    except SpecError as error:
        # The file as it is has no fault, and lines are those of the changed text, which nobody sees.
        options = {".".join(key): name for name, (key, _) in given.items()}
        told = (replace(fault, line=0, column=0, path=_named(fault.path, options)) for fault in error.faults)
        raise SpecError(tuple(told), shown(file)) from error


def text_with(spec: MissionSpec, file: Path, given: Given) -> str:
    """The text of a mission's file with what was given."""
    values: dict[Key, Any] = {}
    for name, (key, value) in given.items():
        besides = CHANGES[name].besides if name in CHANGES else None
        if besides is not None and spec.automaton is not None:
            values[besides] = GONE
        values[key] = value
    return with_values(content_of(file).decode("utf-8-sig"), values)


def _named(path: str, options: dict[str, str]) -> str:
    """The option that a fault is about, or the key in the mission."""
    return next((name for key, name in options.items() if path == key or path.startswith((f"{key}.", f"{key}["))), path)
