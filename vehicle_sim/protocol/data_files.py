"""Tables that are data: files of JSON beside this one, in the folder `data`."""

from importlib.resources import files
from json import loads
from typing import Any


def source(name: str) -> bytes:
    """Return a file as it is, by its name without `.json`."""
    return files(__package__).joinpath("data", f"{name}.json").read_bytes()


def data_file(name: str) -> dict[str, Any]:
    """Return what is in a file."""
    content: dict[str, Any] = loads(source(name))
    return content
