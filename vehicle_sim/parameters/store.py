"""A typed store of parameters: names, kinds, bounds and meanings, with the values that are set now."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum, StrEnum
from math import copysign, isfinite
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

    @property
    def limits(self) -> tuple[float, float]:
        """The least and the greatest value that can be stored."""
        return _LIMITS[self]


_LIMITS: Final[Mapping[ParameterKind, tuple[float, float]]] = {
    ParameterKind.INT8: (-(2**7), 2**7 - 1),
    ParameterKind.INT16: (-(2**15), 2**15 - 1),
    ParameterKind.INT32: (-(2**31), 2**31 - 1),
    # Beyond it there may be no number in single precision.
    ParameterKind.REAL32: (-3.4e38, 3.4e38),
}
_LONGEST_NAME: Final = 16
_UPWARDS: Final = 0.01
"""ArduPilot adds so much to the size of a number that it stores as a whole one, and drops the rest (`AP_Param.cpp`)."""


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
        """Return `value` as it is stored: a whole number of its kind's size, or one of single precision.

        Neither autopilot refuses what it cannot go by: it stores it, and goes by the nearest that it can.

        Raises:
            ParameterError: The value is not finite.
        """
        if not isfinite(value):
            raise ParameterError(f"{self.name} takes a finite number, not {value}")
        least, most = self.kind.limits
        if not self.is_integer:
            return single(max(least, min(value, most)))
        return max(least, min(int(value + copysign(_UPWARDS, value)), most))

    def obeyed(self, stored: float) -> float:
        """Return the value that the vehicle goes by where `stored` is stored."""
        low, high = self.minimum, self.maximum
        if not self.is_integer:
            low, high = single(low), single(high)
        return max(low, min(stored, high))


def single(value: float) -> float:
    """Return the single-precision number nearest to `value`: what a parameter looks like on the wire."""
    return float(unpack("<f", pack("<f", value))[0])


class ParameterStore:
    """The parameters of one vehicle; the order of names is alphabetical and an index is a place in it.

    What is looked up by name is what the vehicle goes by, which lies within the parameter's bounds; what was stored is
    in `stored`.

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
        self._stored = {parameter.name: parameter.stored(parameter.default) for parameter in ordered}
        self._values = self._stored.copy()
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

    def stored(self, name: str) -> float:
        """Return what is stored under `name`, which clients see and files keep.

        Raises:
            KeyError: There is no such parameter.
        """
        return self._stored[name]

    def require_obeyed(self, name: str) -> None:
        """Refuse what is stored under `name` where the vehicle cannot go by it.

        Raises:
            ParameterError: It goes by another value.
        """
        if self._values[name] != self._stored[name]:
            definition = self._definitions[name]
            raise ParameterError(
                f"{name} takes {definition.minimum:g} to {definition.maximum:g}, not {self._stored[name]:g}"
            )

    def set(self, name: str, value: float) -> float:
        """Store `value` under `name` and return what was really stored.

        Raises:
            ParameterError: There is no such parameter, it is a fact and another one, or the value is not finite;
                nothing is changed then.
        """
        if name not in self._definitions:
            raise ParameterError(f"there is no parameter {name!r}")
        definition = self._definitions[name]
        stored, before = definition.stored(value), self._stored[name]
        if definition.read_only and stored != before:
            raise ParameterError(f"{name} is a fact about the vehicle: it is {before:g}")
        self._keep(definition, stored)
        return stored

    def tell(self, name: str, value: float) -> None:
        """Say what a fact is now, where there is one of this name."""
        definition = self._definitions.get(name)
        if definition is not None:
            self._keep(definition, definition.stored(value))

    def _keep(self, definition: Parameter, stored: float) -> None:
        if stored == self._stored[definition.name]:
            return
        self._stored[definition.name], self._values[definition.name] = stored, definition.obeyed(stored)
        self.revision += 1
        for watcher in self._watchers:
            watcher()

    def watch(self, watcher: Callable[[], None]) -> None:
        """Call `watcher` after every change from now on, before the `set` that made it returns."""
        self._watchers.append(watcher)

    def reset(self) -> None:
        """Set every parameter to its default; facts stay."""
        for name, definition in self._definitions.items():
            if not definition.read_only:
                self.set(name, definition.default)
