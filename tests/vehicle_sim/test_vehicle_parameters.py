import re
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle_sim.errors import ConfigurationError, ParameterError
from vehicle_sim.parameters import Flavour, Parameter, ParameterKind, ParameterStore, default_parameters
from vehicle_sim.parameters.settings import flight_settings
from vehicle_sim.protocol.flavour import TABLES
from vehicle_sim.vehicle import Vehicle, VehicleConfig

BOTH = pytest.mark.parametrize("flavour", list(Flavour))


def obeyed(store: ParameterStore) -> list[str]:
    """Return the names of the parameters that the vehicle goes by; what is told about it alone is none."""
    definitions = [store.definition(name) for name in store]
    return [one.name for one in definitions if one.meaning and not one.read_only]


@BOTH
def test_tables_are_in_order_and_whole(flavour: Flavour) -> None:
    store = default_parameters(flavour)
    assert list(store) == sorted(store)
    assert len(store) == len(set(store.names)) == {Flavour.ARDUPILOT: 1379, Flavour.PX4: 927}[flavour]
    assert 150 < len(obeyed(store)) < 250
    for name in store:
        definition = store.definition(name)
        assert (definition.minimum, definition.maximum) == definition.kind.limits or definition.meaning
        assert store[name] == store.stored(name) == definition.stored(definition.default)


@BOTH
def test_every_bound_can_be_stored_and_flown_with(flavour: Flavour) -> None:
    store = default_parameters(flavour)
    for name in obeyed(store):
        definition = store.definition(name)
        for value in (definition.minimum, definition.maximum, definition.default):
            assert store.set(name, value) == store[name]
            flight_settings(store)


@BOTH
def test_what_is_out_of_bounds_is_stored_and_the_bound_is_flown(flavour: Flavour) -> None:
    store = default_parameters(flavour)
    for name in obeyed(store):
        definition = store.definition(name)
        least, most = definition.kind.limits
        for value in (-1e9, 1e9):
            stored = store.set(name, value)
            assert store.stored(name) == stored == max(least, min(value, most))
            assert store[name] == pytest.approx(max(definition.minimum, min(stored, definition.maximum)))
            flight_settings(store)


@BOTH
def test_every_setting_depends_on_some_parameter_alone(flavour: Flavour) -> None:
    """No parameter of flight is there for show: each changes the settings, or is read by name elsewhere."""
    elsewhere = {"MAV_SYSID", "MAV_SYS_ID", "SYS_FAILURE_EN"}
    elsewhere |= {"RCMAP_ROLL", "RCMAP_PITCH", "RCMAP_THROTTLE", "RCMAP_YAW"}
    elsewhere |= {name for names in TABLES[flavour].stream_parameters.values() for name in names.values()}
    # Channels without a stick and positions of a switch without a channel wait for one.
    worlds = re.compile(r"SIM_|COMPASS_OFS_|CAM|MNT|TRIG_|RC\d+_|RC_FAILS_THR")
    names = {name for name in obeyed(default_parameters(flavour)) if not worlds.match(name)}
    for name in names - elsewhere:
        definition = default_parameters(flavour).definition(name)
        choices = definition.is_integer and definition.maximum < 10
        values = range(int(definition.minimum), int(definition.maximum) + 1) if choices else ()
        seen = set()
        for value in (definition.minimum, definition.default, definition.maximum, *values):
            store = default_parameters(flavour)
            store.set(name, value)
            seen.add(flight_settings(store))
        assert len(seen) > 1, name


def test_facts_are_told_and_outlast_a_reset_but_nobody_sets_them() -> None:
    store = default_parameters(Flavour.ARDUPILOT)
    store.tell("MIS_TOTAL", 7)
    store.tell("NO_SUCH", 7)
    with pytest.raises(ParameterError, match="it is 7"):
        store.set("MIS_TOTAL", 0)
    store.reset()
    assert store["MIS_TOTAL"] == 7


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_bad_values_change_nothing(value: float) -> None:
    store = default_parameters(Flavour.ARDUPILOT)
    before, revision = {name: store[name] for name in store}, store.revision
    for name in store:
        with pytest.raises(ParameterError, match=name):
            store.set(name, value)
    with pytest.raises(ParameterError, match="NO_SUCH"):
        store.set("NO_SUCH", 1.0)
    assert {name: store[name] for name in store} == before
    assert store.revision == revision


@given(value=st.floats(-200.0, 200.0))
def test_integers_lose_their_fraction_and_stay_in_their_kind(value: float) -> None:
    store = ParameterStore(Flavour.PX4, [Parameter("A", ParameterKind.INT8, 0, -1000, 1000, "anything")])
    stored = store.set("A", value)
    assert -128 <= stored <= 127
    if abs(value) <= 127:
        assert 0.0 <= abs(value) + 0.01 - abs(stored) < 1.0


def test_definitions_must_make_sense() -> None:
    with pytest.raises(ValueError, match="16"):
        Parameter("SEVENTEEN_LETTERS", ParameterKind.REAL32, 0, 0, 1, "too long")
    with pytest.raises(ValueError, match="default"):
        Parameter("A", ParameterKind.REAL32, 2, 0, 1, "out of bounds")
    twice = Parameter("A", ParameterKind.REAL32, 0, 0, 1, "once")
    with pytest.raises(ValueError, match="twice"):
        ParameterStore(Flavour.PX4, [twice, twice])


@pytest.mark.parametrize(
    "options",
    [
        {"seed": -1},
        {"home_lat_deg": 90.0},
        {"home_lon_deg": 181.0},
        {"home_alt_m": nan},
        {"step_s": 0.0},
        {"step_s": 0.5},
        {"wind_m_s": -1.0},
        {"wind_m_s": 40.0},
        {"gust_m_s": nan},
        {"wind_from_deg": inf},
        {"flavour": "px4"},
    ],
)
def test_vehicles_that_cannot_be_are_refused(options: dict[str, object]) -> None:
    with pytest.raises(ConfigurationError):
        VehicleConfig(**options)  # type: ignore[arg-type]  # wrong on purpose


def test_parameters_of_another_flavour_are_refused() -> None:
    with pytest.raises(ConfigurationError, match="px4"):
        Vehicle(VehicleConfig(), default_parameters(Flavour.PX4))


def test_wind_can_be_changed_by_parameter_in_flight() -> None:
    vehicle = Vehicle(VehicleConfig(wind_m_s=3.0, wind_from_deg=270.0))
    vehicle.step()
    assert vehicle.wind_ned_m_s == pytest.approx((0.0, 3.0, 0.0), abs=1e-9)
    vehicle.parameters.set("SIM_WIND_SPD", 5.0)
    for _ in range(5):
        vehicle.step()
    assert vehicle.wind_ned_m_s == pytest.approx((0.0, 5.0, 0.0), abs=1e-9)
