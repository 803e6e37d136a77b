"""JSON from outside: decoded, bounded, its values taken out with the path of what is not as it must be."""

import json
from typing import Any, NoReturn

from mission.interchange.features import Point, broken
from mission.interchange.rings import number

Json = Any


def decoded_json(content: bytes) -> Json:
    """The value of a JSON text.

    Raises:
        SpecError: It is none, with line and column.
    """
    try:
        return json.loads(content.decode("utf-8-sig"), parse_constant=_no_number)
    except UnicodeDecodeError as error:
        at = content[: error.start].count(b"\n") + 1
        raise broken(f"the byte 0x{content[error.start]:02x} is not UTF-8", "save the file as UTF-8", line=at) from None
    except json.JSONDecodeError as error:
        message = f"this is not JSON: {error.msg}"
        raise broken(message, "the file may have been cut off", line=error.lineno, column=error.colno) from None
    except RecursionError:
        raise broken("lists and objects are nested too deeply") from None
    except ValueError as error:
        raise broken(f"this is not JSON: {error}") from None


def member(value: Json, key: str, kind: type, path: str) -> Json:
    """A member of an object, which must be there and be of a kind.

    Raises:
        SpecError: It is not.
    """
    if not isinstance(value, dict):
        raise broken(f"expected an object, found {_found(value)}", path=path)
    inner = f"{path}.{key}" if path else key
    if key not in value:
        raise broken(f"`{key}` is missing", path=path)
    if not isinstance(value[key], kind):
        expected = "a list" if kind is list else "an object" if kind is dict else "text"
        raise broken(f"expected {expected}, found {_found(value[key])}", path=inner)
    return value[key]


def point(value: Json, path: str, *, latitude_first: bool = False) -> Point:
    """A position, [x, y] and maybe more, as the pair (x, y).

    Raises:
        SpecError: It is none.
    """
    pair = [number(each) for each in value[:2]] if isinstance(value, list) else []
    if len(pair) < 2 or pair[0] is None or pair[1] is None:  # noqa: PLR2004 - the plane
        order = "[latitude, longitude]" if latitude_first else "[longitude, latitude]"
        raise broken(f"expected a position {order}, found {_found(value)}", path=path)
    return (pair[1], pair[0]) if latitude_first else (pair[0], pair[1])


def points(value: Json, path: str, *, latitude_first: bool = False) -> list[Point]:
    """A list of positions.

    Raises:
        SpecError: It is none.
    """
    if not isinstance(value, list):
        raise broken(f"expected a list of positions, found {_found(value)}", path=path)
    return [point(each, f"{path}[{i}]", latitude_first=latitude_first) for i, each in enumerate(value)]


def _found(value: Json) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 40 else f"{text[:37]}..."  # noqa: PLR2004 - what a message can show


def _no_number(text: str) -> NoReturn:
    raise ValueError(f"{text} is no number")
