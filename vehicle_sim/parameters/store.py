"""A typed store of parameters: names, kinds, bounds and meanings, with the values that are set now."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from enum import Enum, StrEnum
from math import isfinite
from struct import pack, unpack
from typing import Final

from vehicle_sim.errors import ParameterError


class Flavour(StrEnum):
    """Which autopilot the vehicle answers like."""

    ARDUPILOT = "ardupilot"
    PX4 = "px4"


class ParameterKind(Enum):
    """Storage of a parameter; the values are those of MAV_PARAM_TYPE."""

    INT8 = 2
    INT16 = 4
    INT32 = 6
    REAL32 = 9


_INTEGER_LIMITS: Final = {
    ParameterKind.INT8: (-(2**7), 2**7 - 1),
    ParameterKind.INT16: (-(2**15), 2**15 - 1),
    ParameterKind.INT32: (-(2**31), 2**31 - 1),
}
_LONGEST_NAME: Final = 16
_LARGEST: Final = 3.4e38
"""Beyond it there may be no number in single precision."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter: its name (at most 16 characters), kind, default, bounds and meaning with its unit.

    One that is `read_only` is a fact about the vehicle, which clients look up and nobody can change.

    Raises:
        ValueError: The name is too long, or the default does not lie within the bounds.
    """

    name: str
    kind: ParameterKind
    default: float
    minimum: float
    maximum: float
    meaning: str
    read_only: bool = False

    def __post_init__(self) -> None:
        """Refuse a definition that contradicts itself."""
        if not 0 < len(self.name) <= _LONGEST_NAME:
            raise ValueError(f"parameter name {self.name!r} has not 1 to {_LONGEST_NAME} characters")
        if not self.minimum <= self.default <= self.maximum:
            raise ValueError(f"{self.name}: the default {self.default} is not in [{self.minimum}, {self.maximum}]")

    @property
    def is_integer(self) -> bool:
        """Whether the value is a whole number."""
        return self.kind is not ParameterKind.REAL32

    def stored(self, value: float) -> float:
        """Return `value` as it would be stored: rounded to a whole number or to single precision.

        Raises:
            ParameterError: The value is not finite or out of bounds.
        """
        if not isfinite(value):
            raise ParameterError(f"{self.name} takes a finite number, not {value}")
        if self.is_integer:
            value = round(value)
            least, greatest = _INTEGER_LIMITS[self.kind]
            low, high = max(self.minimum, least), min(self.maximum, greatest)
        else:
            # What is stored is compared: a bound that arrives rounded, by wire or by file, is still the bound.
            low, high = single(self.minimum), single(self.maximum)
            value = single(value) if abs(value) < _LARGEST else value
        if not low <= value <= high:
            raise ParameterError(f"{self.name} takes {low:g} to {high:g}, not {value:g}")
        return value


def single(value: float) -> float:
    """Return the single-precision number nearest to `value`: what a parameter looks like on the wire."""
    return float(unpack("<f", pack("<f", value))[0])


class ParameterStore:
    """The parameters of one vehicle; the order of names is alphabetical and an index is a place in it.

    Attributes:
        revision: Grows with every change.
    """

    def __init__(self, flavour: Flavour, definitions: Iterable[Parameter]) -> None:
        """Hold `definitions` at their defaults.

        Raises:
            ValueError: A name is defined twice.
        """
        self.flavour = flavour
        ordered = sorted(definitions, key=lambda parameter: parameter.name)
        self._definitions = {parameter.name: parameter for parameter in ordered}
        if len(self._definitions) != len(ordered):
            raise ValueError("a parameter is defined twice")
        self.names: Final = tuple(self._definitions)
        self._values: dict[str, float] = {parameter.name: parameter.stored(parameter.default) for parameter in ordered}
        self.revision = 0
        self._watchers: list[Callable[[], None]] = []

    def __len__(self) -> int:
        return len(self.names)

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self._values

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def definition(self, name: str) -> Parameter:
        """Return how `name` is defined.

        Raises:
            KeyError: There is no such parameter.
        """
        return self._definitions[name]

    def set(self, name: str, value: float) -> float:
        """Store `value` under `name` and return what was really stored.

        Raises:
            ParameterError: There is no such parameter, or it cannot take the value; nothing is changed then.
        """
        if name not in self._definitions:
            raise ParameterError(f"there is no parameter {name!r}")
        definition = self._definitions[name]
        if definition.read_only and value != self._values[name]:
            raise ParameterError(f"{name} is a fact about the vehicle: it is {self._values[name]:g}")
        stored = definition.stored(value)
        if stored != self._values[name]:
            self._values[name] = stored
            self.revision += 1
            for watcher in self._watchers:
                watcher()
        return stored

    def watch(self, watcher: Callable[[], None]) -> None:
        """Call `watcher` after every change from now on, before the `set` that made it returns."""
        self._watchers.append(watcher)

    def reset(self) -> None:
        """Set every parameter to its default."""
        for name, definition in self._definitions.items():
            self.set(name, definition.default)
