"""What PX4's events mean: the file that ground stations fetch, `data/all_events.json`, as the vehicle itself uses it.

https://mavlink.io/en/services/events.html. An event's number is made of its name: 24 bits of FNV-1a, and 1 above them.
"""

import re
from collections.abc import Callable
from functools import cache
from struct import Struct
from typing import Any, Final, NamedTuple

from vehicle_sim.protocol.data_files import data_file

_COMPONENT: Final = 1 << 24
_FORMATS: Final = {"uint8_t": "B", "uint32_t": "I", "int32_t": "i", "float": "f"}
_ARGUMENT: Final = re.compile(r"\{(\d)(?::\.\d)?(m?)(?:_v)?\}")


class Definition(NamedTuple):
    """One event.

    Attributes:
        number: What stands for it on the wire.
        packing: Its arguments.
        text: What it says; its groups are the arguments that are shown.
        readers: Which argument each of them is, and what makes the number of it.
    """

    number: int
    packing: Struct
    text: re.Pattern[str]
    readers: tuple[tuple[int, Callable[[str], float]], ...]


class EventList:
    """The events, and what they name.

    Attributes:
        events: By their names.
        mode_bits: The bit of each mode, by its number in heartbeats.
        component_bits: The bit of each part of the vehicle, by its name.
    """

    def __init__(self) -> None:
        file = data_file("all_events")["components"]["1"]
        self._enums = file["enums"]
        groups = file["navigation_mode_groups"]["groups"]
        self.mode_bits = {number: 1 << int(index) for index, numbers in groups.items() for number in numbers}
        self.component_bits = self._values("health_component_t", "name")
        self.events: dict[str, Definition] = {
            event["name"]: self._definition(int(number), event)
            for group in file["event_groups"].values()
            for number, event in group["events"].items()
        }

    def find(self, text: str) -> tuple[str, list[float]] | None:
        """Return the event that says `text`, and its arguments; None where there is none."""
        for name, event in self.events.items():
            if (found := event.text.fullmatch(text)) is not None:
                arguments = sorted(zip(event.readers, found.groups(), strict=True), key=lambda pair: pair[0][0])
                return name, [reader(word) for (_place, reader), word in arguments]
        return None

    def _definition(self, number: int, event: dict[str, Any]) -> Definition:
        kinds = [argument["type"] for argument in event.get("arguments", ())]
        bases = [self._enums[kind]["type"] if kind in self._enums else kind for kind in kinds]
        pattern, at, readers = "", 0, []
        for shown in _ARGUMENT.finditer(event["message"]):
            place = int(shown[1]) - 1
            words = self._values(kinds[place], "description") if kinds[place] in self._enums else None
            choice = "[-0-9.]+" if words is None else "|".join(map(re.escape, words))
            pattern += f"{re.escape(event['message'][at : shown.start()])}({choice}){' m' if shown[2] else ''}"
            readers.append((place, float if words is None else words.__getitem__))
            at = shown.end()
        pattern += re.escape(event["message"][at:])
        packing = Struct("<" + "".join(_FORMATS[base] for base in bases))
        return Definition(_COMPONENT | number, packing, re.compile(pattern), tuple(readers))

    def _values(self, enum: str, key: str) -> dict[str, int]:
        return {entry[key]: int(value) for value, entry in self._enums[enum]["entries"].items()}


@cache
def event_list() -> EventList:
    """Return what the file says."""
    return EventList()
