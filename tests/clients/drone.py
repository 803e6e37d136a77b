"""What both versions of MAVSDK have in common: plugins by name, streams of telemetry, and how this is told.

The client programs run in environments of their own, with nothing but MAVSDK in them; so this file and the scenarios
import the standard library only. Each fact is one line of JSON on standard output: a topic and a value.
"""

import asyncio
import json
import sys
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from math import isfinite
from typing import Any

PATIENCE_S = 25.0


@dataclass(frozen=True)
class Drone:
    """One connected vehicle as a version of MAVSDK shows it.

    Attributes:
        action, geofence, ...: The plugins.
        stream: Opens a stream of telemetry by its name.
        flights: Opens the stream of what is told of the present flight.
        progress: Opens the stream of a mission's progress, of the plugin `mission` or `mission_raw`.
        types: The module of a plugin by name: where its types and errors are.
        reports: Opens the stream of reports of arming checks, where the version has that plugin.
    """

    action: Any
    geofence: Any
    info: Any
    log_files: Any
    ftp: Any
    mission: Any
    mission_raw: Any
    offboard: Any
    param: Any
    telemetry: Any
    stream: Callable[[str], AsyncIterator[Any]]
    flights: Callable[[], AsyncIterator[Any]]
    progress: Callable[[str], AsyncIterator[Any]]
    types: Callable[[str], Any]
    reports: Callable[[], AsyncIterator[Any]] | None = None


def plain(value: object) -> object:
    """Return `value` as JSON can say it: enumerations by name, objects by their attributes, no number as null."""
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, str | int) or value is None:
        return value
    if hasattr(value, "__dict__"):
        return {name: plain(one) for name, one in vars(value).items()}
    return [plain(one) for one in value] if isinstance(value, Iterable) else str(value)


def tell(topic: str, value: object = None) -> None:
    """Print one fact."""
    sys.stdout.write(json.dumps({"topic": topic, "value": plain(value)}) + "\n")
    sys.stdout.flush()


async def seen(
    stream: AsyncIterator[Any], holds: Callable[[Any], bool] = lambda _value: True, *, within_s: float = PATIENCE_S
) -> Any:  # noqa: ANN401 - MAVSDK's own types
    """Return the first value of `stream` for which `holds` is true, and close the stream.

    Raises:
        TimeoutError: None came in time; it says what came last.
    """
    last: Any = "nothing"
    try:
        async with asyncio.timeout(within_s):
            async for value in stream:
                last = value
                if holds(value):
                    return value
    except TimeoutError:
        raise TimeoutError(f"last seen: {plain(last)}") from None
    finally:
        close = getattr(stream, "aclose", None)
        if close is not None:
            await close()
    raise TimeoutError(f"the stream has ended, last seen: {plain(last)}")


async def refused(request: Awaitable[object]) -> object:
    """Return the result with which a request was refused; None where it was accepted."""
    try:
        await request
    except Exception as error:
        # Version 3 keeps a message around the result, version 4 the result itself.
        result = getattr(error, "_result", None) or getattr(error, "result", None)
        if result is None:
            raise
        return getattr(result, "result", result)
    return None


async def told(topic: str, step: Awaitable[object]) -> None:
    """Do one step of a scenario and tell what came of it; one that fails is told as such and does not end the rest.

    A step that has nothing to say but that it succeeded is told as true.
    """
    try:
        value = plain(await step)
    except Exception as error:  # noqa: BLE001 - each plugin of each version has its own, and all of them are facts
        tell(f"{topic}: failed", f"{type(error).__name__}: {error}")
    else:
        tell(topic, value in (None, "SUCCESS") or value)
