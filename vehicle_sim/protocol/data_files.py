"""Tables that are data: files of JSON beside this one, in the folder `data`."""

from functools import cache
from json import loads
from pathlib import Path
from typing import Any


def source(name: str) -> bytes:
    """Return a file as it is, by its name without `.json`."""
    return (Path(__file__).with_name("data") / f"{name}.json").read_bytes()


@cache
def data_file(name: str) -> dict[str, Any]:
    """Return what is in a file, which nobody changes: it is read once."""
    content: dict[str, Any] = loads(source(name))
    return content
