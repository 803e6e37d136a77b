"""Everything that an object holds, as one value that can be compared: the whole state, not a choice of it."""

from collections import deque
from collections.abc import Callable, Mapping
from enum import Enum
from types import BuiltinFunctionType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

_PLAIN = (int, str, bytes, bool, complex, type(None), Enum, type, range)
_CODE = (FunctionType, MethodType, BuiltinFunctionType, ModuleType)


def snapshot(thing: object, *, without: frozenset[str] = frozenset()) -> Any:  # noqa: ANN401 - a value of any shape
    """Return a comparable copy of all that can be reached from `thing`, but for the attributes named `without`."""
    return _Copier(without).copy(thing)


class _Copier:
    def __init__(self, without: frozenset[str]) -> None:
        self._without = without
        self._seen: dict[int, int] = {}
        self._rules: tuple[tuple[type | tuple[type, ...], Callable[[Any], Any]], ...] = (
            (np.ndarray, lambda array: (array.shape, array.tobytes())),
            (np.random.Generator, lambda generator: repr(generator.bit_generator.state)),
            (bytearray, bytes),
            (Mapping, lambda mapping: [(self.copy(key), self.copy(value)) for key, value in mapping.items()]),
            ((list, tuple, deque), lambda items: [self.copy(item) for item in items]),
            ((set, frozenset), lambda items: sorted(repr(item) for item in items)),
        )

    def copy(self, thing: Any) -> Any:  # noqa: ANN401
        if isinstance(thing, float):
            return repr(thing)  # a NaN equals itself here
        if isinstance(thing, _PLAIN):
            return thing
        if isinstance(thing, _CODE):
            return "code"
        if id(thing) in self._seen:
            return ("seen", self._seen[id(thing)])
        self._seen[id(thing)] = len(self._seen)
        for kinds, rule in self._rules:
            if isinstance(thing, kinds):
                return rule(thing)
        return (type(thing).__name__, [(name, self.copy(value)) for name, value in self._held(thing)])

    def _held(self, thing: Any) -> list[tuple[str, Any]]:  # noqa: ANN401
        held = dict(getattr(thing, "__dict__", {}))
        for kind in type(thing).__mro__:
            slots = getattr(kind, "__slots__", ())
            for name in (slots,) if isinstance(slots, str) else slots:
                if hasattr(thing, name):
                    held[name] = getattr(thing, name)
        return [(name, value) for name, value in sorted(held.items()) if name not in self._without]
