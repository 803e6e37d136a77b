"""The parameters of each flavour, from the table beside this file: `ardupilot.tsv`, `px4.tsv`.

A row is a name, MAV_PARAM_TYPE's name of its storage and its default, between tabs. Those that the vehicle obeys have
three columns more: the least and the greatest value that it goes by, and what they mean, with the unit. What the
vehicle cannot be told is marked `fact: `. Names, types and defaults are those that ArduCopter 4.7.0-dev and PX4 list in
their own simulators, but for what differs in the vehicle: its camera and mount, the capacity and cells of its battery,
rates and time-outs as they are at real time and before a client has asked; the faults of the world, `SIM_*`, are in
both.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Final

from vehicle_sim.parameters.store import Flavour, Parameter, ParameterKind, ParameterStore

_FACT: Final = "fact: "


@cache
def _table(flavour: Flavour) -> tuple[Parameter, ...]:
    rows = Path(__file__).with_name(f"{flavour.value}.tsv").read_text(encoding="utf-8").splitlines()
    return tuple(_parameter(row.split("\t")) for row in rows)


def _parameter(row: Sequence[str]) -> Parameter:
    name, kind_name, default, least, most, meaning = (*row, "", "", "")[:6]
    kind = ParameterKind[kind_name]
    low, high = kind.limits
    return Parameter(
        name,
        kind,
        float(default),
        float(least) if least else low,
        float(most) if most else high,
        meaning.removeprefix(_FACT),
        read_only=meaning.startswith(_FACT),
    )


def default_parameters(flavour: Flavour) -> ParameterStore:
    """Return a store with all parameters of `flavour` at their defaults."""
    return ParameterStore(flavour, _table(flavour))
