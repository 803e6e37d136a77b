"""Fault x moment x setting x flavour: each flight completes, holds, returns or lands by the rule of its fault.

The rules are those of the table of faults in mission/README.md. In the suite there is a flight for each fault, each
moment and each setting; ``-m long`` flies all.
"""

from collections.abc import Mapping
from typing import Final, NamedTuple

import pytest

from tests.support.fault_grid import Cell, Fault, Moment, Outcome, Setting, ended
from vehicle_sim.parameters import Flavour

ARDUPILOT, PX4 = Flavour.ARDUPILOT, Flavour.PX4
COMPLETES, HOLDS, RETURNS, LANDS, STAYS = (
    Outcome.COMPLETES,
    Outcome.HOLDS,
    Outcome.RETURNS,
    Outcome.LANDS,
    Outcome.STAYS,
)


class Rule(NamedTuple):
    """Where a fault leaves a vehicle: on the ground before the flight, in the air, and while it lands.

    ``astray`` is whether the vehicle does not know where wind takes it, and lands elsewhere by what it says itself.
    """

    ground: Outcome
    air: Outcome
    landing: Outcome
    astray: bool = False


FINE: Final = Rule(COMPLETES, COMPLETES, COMPLETES)
RULES: Final[Mapping[Fault, Mapping[Flavour, Rule]]] = {
    fault: {ARDUPILOT: ardupilot, PX4: px4}
    for fault, ardupilot, px4 in (
        (Fault.LINK_CUT, Rule(STAYS, HOLDS, LANDS), Rule(STAYS, HOLDS, LANDS)),
        (Fault.LINK_CUT_BRIEFLY, FINE, FINE),
        (Fault.LINK_LOSES, FINE, FINE),
        (
            Fault.GPS_LOST,
            Rule(LANDS, LANDS, COMPLETES, astray=True),
            Rule(LANDS, LANDS, COMPLETES, astray=True),
        ),
        (Fault.GPS_LOST_BRIEFLY, FINE, FINE),
        # PX4 stops landing once its estimator has gone over to where the receiver says that it is. Where it was about
        # to lift off, it is disarmed before.
        (
            Fault.ESTIMATOR,
            Rule(LANDS, LANDS, COMPLETES, astray=True),
            Rule(LANDS, HOLDS, COMPLETES, astray=True),
        ),
        (Fault.MOTOR, FINE, FINE),
        (Fault.BATTERY, Rule(STAYS, LANDS, COMPLETES), Rule(STAYS, LANDS, COMPLETES)),
        (Fault.FENCE, Rule(RETURNS, RETURNS, COMPLETES), Rule(HOLDS, HOLDS, COMPLETES)),
        (Fault.PILOT, Rule(STAYS, HOLDS, HOLDS), Rule(STAYS, HOLDS, HOLDS)),
        (Fault.GROUND_STATION, Rule(STAYS, RETURNS, RETURNS), Rule(STAYS, RETURNS, RETURNS)),
        (Fault.KILLED, Rule(STAYS, HOLDS, LANDS), Rule(STAYS, HOLDS, LANDS)),
        (Fault.DISK, FINE, FINE),
        (Fault.CLOCK, FINE, FINE),
        (Fault.REBOOT, Rule(STAYS, LANDS, LANDS), Rule(STAYS, LANDS, LANDS)),
    )
}


def expected(cell: Cell) -> Outcome:
    rule = RULES[cell.fault][cell.flavour]
    if rule.astray and cell.moment is Moment.LANDING and cell.setting is Setting.WIND:
        return LANDS
    return {Moment.ON_THE_GROUND: rule.ground, Moment.LANDING: rule.landing}.get(cell.moment, rule.air)


CELLS: Final = [
    Cell(fault, moment, setting, flavour)
    for fault in Fault
    for moment in Moment
    for setting in Setting
    for flavour in Flavour
]


def sample() -> frozenset[Cell]:
    """A cell for each fault; each moment, setting and flavour comes several times.

    PX4 flies in wind and ArduPilot without, so that when the moments come has to be flown for no more than these two.
    """
    moments, ways = list(Moment), [(Setting.USUAL, ARDUPILOT), (Setting.WIND, PX4), (Setting.LANDS, ARDUPILOT)]
    return frozenset(Cell(fault, moments[2 * i % len(moments)], *ways[i % len(ways)]) for i, fault in enumerate(Fault))


SAMPLE: Final = sample()


def test_the_sample_has_each_fault_moment_setting_and_flavour() -> None:
    for place, of in enumerate((Fault, Moment, Setting, Flavour)):
        assert {getattr(cell, ("fault", "moment", "setting", "flavour")[place]) for cell in SAMPLE} == set(of)


@pytest.mark.parametrize(
    "cell",
    [
        pytest.param(
            cell,
            marks=() if cell in SAMPLE else pytest.mark.long,
            id=f"{cell.fault}, {cell.moment}, {cell.setting}, {cell.flavour.value}",
        )
        for cell in CELLS
    ],
)
def test_each_fault_at_each_moment_ends_by_its_rule(cell: Cell) -> None:
    found = ended(cell)
    assert found.outcome is expected(cell), found.words
    if cell.fault is Fault.KILLED:
        assert found.record.verdict is None  # and yet it opens
        return
    assert found.record.verdict is not None or cell.fault is Fault.DISK
    assert found.words
    if found.armed:
        assert any(words in found.words for words in ("left holding in", "last heard in", "put the vehicle into"))
