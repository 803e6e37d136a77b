"""The charge in flight: what reports tell of it, and the table of what follows."""

import math
from collections.abc import Callable
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.monitor.charge import Charge, Prospect, Resolve, least_share, resolved, share
from mission.spec.battery import Battery

SOME = st.floats(1.0, 60.0)


def told(charge: Charge, current_a: float, until_s: float, step_s: float = 2.0, full_mah: float = 5000.0) -> float:
    """A steady current in reports as an autopilot makes them; the last one's time."""
    steps = int(until_s / step_s)
    for k in range(steps + 1):
        drawn = current_a * k * step_s / 3.6
        charge.tell(k * step_s, round(drawn), math.floor(100.0 * (1.0 - drawn / full_mah)))
    return steps * step_s


def test_before_anything_is_told_all_is_possible() -> None:
    charge = Charge(Battery(10.0), 5000.0)
    assert not charge.is_known
    assert charge.left_mah(0.0) == math.inf


@given(SOME, st.floats(2.0, 40.0))
def test_the_mean_current_is_first_the_files_and_then_what_is_drawn(filed_a: float, drawn_a: float) -> None:
    charge = Charge(Battery(filed_a), 50_000.0)
    assert charge.current_a == filed_a
    told(charge, drawn_a, 20.0, full_mah=50_000.0)
    assert min(filed_a, drawn_a) - 0.9 <= charge.current_a <= max(filed_a, drawn_a) + 0.9  # rounding of 1 mAh
    charge = Charge(Battery(filed_a), 50_000.0)
    at_s = told(charge, drawn_a, 600.0, full_mah=50_000.0)
    assert charge.current_a == pytest.approx(drawn_a, abs=0.1 + abs(filed_a - drawn_a) * math.exp(-at_s / 60.0))


@given(SOME)
def test_between_reports_the_charge_goes_on_falling(drawn_a: float) -> None:
    charge = Charge(Battery(drawn_a), 5000.0)
    at_s = told(charge, drawn_a, 60.0)
    assert charge.left_mah(at_s) == pytest.approx(5000.0 - drawn_a * at_s / 3.6, abs=1.0)
    assert charge.left_mah(at_s + 36.0) == pytest.approx(charge.left_mah(at_s) - 10.0 * charge.current_a)
    spare_s = charge.spare_s(at_s, 100.0)
    assert charge.left_mah(at_s + 100.0 + spare_s) == pytest.approx(charge.reserve_mah)


@given(st.floats(0.0, 4900.0), st.sampled_from([math.floor, math.ceil, round]))
def test_of_a_battery_that_was_full_nothing_is_lost_by_rounding(
    drawn_mah: float, rounded: Callable[[float], int]
) -> None:
    charge = Charge(Battery(10.0), 5000.0)
    charge.tell(0.0, round(drawn_mah), rounded(100.0 - drawn_mah / 50.0))
    assert charge.left_mah(0.0) == pytest.approx(5000.0 - drawn_mah, abs=0.51)


@given(st.integers(1, 98))
def test_a_battery_that_was_not_full_is_not_taken_for_one(percent: int) -> None:
    charge = Charge(Battery(10.0), 5000.0)
    charge.tell(0.0, 0.0, float(percent))
    assert charge.left_mah(0.0) == pytest.approx(50.0 * percent)


def test_a_vehicle_that_knows_of_less_is_believed() -> None:
    charge = Charge(Battery(10.0), 5000.0)
    charge.tell(0.0, 0.0, 100.0)
    charge.tell(10.0, 28.0, 60.0)  # cold, or old
    assert charge.left_mah(10.0) == pytest.approx(0.61 * 5000.0)


def test_what_is_not_told_is_not_made_up() -> None:
    charge = Charge(Battery(10.0), 5000.0)
    charge.tell(0.0, 100.0, None)
    assert not charge.is_known
    charge.tell(0.0, None, 50.0)
    charge.tell(60.0, None, 40.0)
    assert charge.left_mah(60.0) == 2000.0
    assert charge.current_a == 10.0
    unknown = Charge(Battery(10.0), 0.0)
    unknown.tell(0.0, 0.0, 100.0)
    assert not unknown.is_known


def test_a_slow_flight_takes_longer() -> None:
    charge = Charge(Battery(10.0), 5000.0)
    for k in range(200):
        charge.tell(2.0 * k, None, 90.0, 0.5)
    assert charge.flying_s(30.0) == pytest.approx(60.0, rel=0.01)


@pytest.mark.parametrize(
    ("rest_s", "return_s", "straight_s", "fresh"),
    list(product((-1.0, 1.0), (None, -1.0, 1.0), (-1.0, 1.0), (False, True))),
)
def test_the_table(rest_s: float, return_s: float | None, straight_s: float, fresh: bool) -> None:  # noqa: FBT001 - a row
    resolve = resolved(Prospect(rest_s, return_s, straight_s, fresh))
    if rest_s > 0.0:
        assert resolve is Resolve.GO_ON
    elif straight_s < 0.0:
        assert resolve is Resolve.GIVE_UP
    elif return_s is not None and return_s > 0.0:
        assert resolve is Resolve.FLY_ON
    else:
        assert resolve is (Resolve.RETURN if fresh and return_s is not None else Resolve.LOOK_BACK)


@given(st.floats(0.0, 60.0), st.floats(0.0, 60.0), st.floats(1.0 / 160.0, 1.0 / 48.0))
def test_what_wind_takes_is_bounded_for_every_vehicle(ahead: float, flown: float, per_w_kg: float) -> None:
    more = (1.0 + per_w_kg * ahead) / (1.0 + per_w_kg * flown)
    assert least_share(flown) - 1e-9 <= more <= share(ahead, flown) + 1e-9
