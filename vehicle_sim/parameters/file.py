"""Parameters as text: one on a line, `NAME VALUE`, with what it means behind it.

The files of MAVProxy (`NAME VALUE`) and Mission Planner (`NAME,VALUE`) are read as well, as far as the vehicle has
their parameters. What follows `#` is a remark.
"""

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Final

from vehicle_sim.errors import ParameterError
from vehicle_sim.parameters.store import Parameter, ParameterStore

MOST_BYTES: Final = 1 << 20
"""No file of parameters is longer."""

_RETIRED: Final[Mapping[str, str | None]] = {
    "ARMING_DELAY_SEC": None,
    "ARMING_SKIPCHK": None,
    "MPC_HOLD_DZ": "MAN_DEADZONE",
}
"""Names in files that older versions have written, and what each is called now; None where there is nothing to set."""

_TITLE: Final = "# Parameters of a vehicle that answers like {flavour}: NAME VALUE  # meaning"


def take_value(store: ParameterStore, name: str, text: str) -> None:
    """Set one parameter from its text.

    Raises:
        ParameterError: There is no such parameter, it is a fact and another one, or it cannot take the value.
    """
    if name not in store:
        close = get_close_matches(name.upper(), store.names, n=1)
        raise ParameterError(f"there is no parameter {name!r}" + (f"; is {close[0]} meant?" if close else ""))
    try:
        value = float(text)
    except ValueError:
        raise ParameterError(f"{name} takes a number, not {text!r}") from None
    definition = store.definition(name)
    if definition.is_integer and value != round(value, 0):
        raise ParameterError(f"{name} takes a whole number, not {text}")
    store.set(name, value)


def take_text(store: ParameterStore, text: str) -> None:
    """Set all parameters that `text` names; the others stay as they are.

    Raises:
        ParameterError: A line that cannot be used, with its number; those before it have been taken.
    """
    seen: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.partition("#")[0].replace(",", " ").split()
        if not words:
            continue
        if len(words) != 2:  # noqa: PLR2004 - a name and its value
            raise ParameterError(f"line {number}: write NAME VALUE, not {line.strip()!r}")
        name = words[0]
        if name in seen:
            raise ParameterError(f"line {number}: {name} stands in line {seen[name]} already")
        seen[name] = number
        current = name if name in store else _RETIRED.get(name, name)
        if current is None:
            continue
        try:
            take_value(store, current, words[1])
        except (ParameterError, OverflowError) as error:
            raise ParameterError(f"line {number}: {error}") from error


def as_text(store: ParameterStore) -> str:
    """Return all parameters as text, facts as remarks; `take_text` gives back exactly the values of the others."""
    lines = [_TITLE.format(flavour=store.flavour.value)]
    for name in store:
        definition = store.definition(name)
        number = _number(definition, store.stored(name))
        line = f"{name:<16} {number:<12} # {definition.meaning}"
        if definition.read_only:
            line = f"# {name:<14} {number:<12} # fact: {definition.meaning}"
        lines.append(line.rstrip("# ") if not definition.meaning else line)
    return "\n".join(lines) + "\n"


def _number(definition: Parameter, value: float) -> str:
    return str(int(value)) if definition.is_integer else f"{value:.9g}"
