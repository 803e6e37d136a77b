"""Strengths over time, and how parameters, schedule and commands add up to one state of the world."""

import itertools
from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.faults import schedule_of
from vehicle_sim.faults import SOUND, FailureType, FailureUnit, Faults, ScheduledFault, SensorState
from vehicle_sim.parameters import Flavour, default_parameters
from vehicle_sim.signals import Vector


def faults_of(*faults: str) -> Faults:
    return Faults(default_parameters(Flavour.ARDUPILOT), schedule_of(*faults))


def at(faults: Faults, now_s: float, *, armed: bool = False, flying: bool = False) -> Faults:
    faults.advance(now_s, armed=armed, flying=flying)
    return faults


@given(for_s=st.floats(0.1, 100.0) | st.just(inf), ramp_share=st.floats(0.0, 0.5), age_s=st.floats(-10.0, 200.0))
def test_a_ramp_is_a_trapezoid(for_s: float, ramp_share: float, age_s: float) -> None:
    ramp_s = ramp_share * min(for_s, 100.0)
    fault = ScheduledFault(kind="gps_loss", values={}, for_s=for_s, ramp_s=ramp_s)
    strength = fault.strength(age_s)
    assert 0.0 <= strength <= 1.0
    if not 0.0 <= age_s < for_s:
        assert strength == 0.0
    elif ramp_s <= age_s <= for_s - ramp_s:
        assert strength == pytest.approx(1.0, abs=1e-9)
    else:
        assert strength == pytest.approx(min(age_s, for_s - age_s) / ramp_s, abs=1e-9)


def test_a_gust_swells_and_fades_without_a_jump() -> None:
    faults = faults_of("gust, at_s: 10, for_s: 4, east_m_s: 8")
    east = [at(faults, 10.0 + 0.05 * k).conditions.wind_ned_m_s[1] for k in range(81)]
    assert (east[0], east[40], east[80]) == pytest.approx((0.0, 8.0, 0.0), abs=1e-9)
    assert max(abs(b - a) for a, b in itertools.pairwise(east)) < 8.0 * 0.05 * 0.8


def test_time_counts_from_the_event_and_from_its_first_time_only() -> None:
    faults = faults_of("gps_loss, since: takeoff, at_s: 5, for_s: 2", "compass_loss, since: arming, at_s: 1")
    assert at(faults, 100.0).conditions == faults_of().conditions
    at(faults, 101.0, armed=True)
    assert at(faults, 102.5, armed=True, flying=True).conditions.compass is SensorState.SILENT
    assert faults.conditions.gps is SensorState.WORKING
    assert at(faults, 107.6).conditions.gps is SensorState.SILENT
    assert at(faults, 109.6, armed=True, flying=True).conditions.gps is SensorState.WORKING
    assert at(faults, 500.0, armed=True, flying=True).conditions.gps is SensorState.WORKING


@pytest.mark.parametrize(
    ("name", "value", "field", "expected"),
    [
        ("SIM_GPS1_ENABLE", 0, "gps", SensorState.SILENT),
        ("SIM_GPS_DISABLE", 1, "gps", SensorState.SILENT),
        ("SIM_GPS1_GLTCH_X", 0.5, "gps_glitch", (0.5, 0.0, 0.0)),
        ("SIM_GPS1_GLTCH_Y", 0.5, "gps_glitch", (0.0, 0.5, 0.0)),
        ("SIM_GPS1_GLTCH_Z", 7, "gps_glitch", (0.0, 0.0, 7.0)),
        ("SIM_GPS1_LAG_MS", 240, "gps_lag_s", 0.24),
        ("SIM_GPS1_NUMSATS", 5, "gps_satellites", 5),
        ("SIM_GPS1_NOISE", 2, "gps_noise_m", 2.0),
        ("SIM_GPS1_VERR_X", 1, "gps_velocity_error_ned_m_s", (1.0, 0.0, 0.0)),
        ("SIM_GPS1_VERR_Y", 1, "gps_velocity_error_ned_m_s", (0.0, 1.0, 0.0)),
        ("SIM_GPS1_VERR_Z", 1, "gps_velocity_error_ned_m_s", (0.0, 0.0, 1.0)),
        ("SIM_ACC1_BIAS_X", 0.5, "accelerometer_bias_m_s2", (0.5, 0.0, 0.0)),
        ("SIM_ACC1_BIAS_Y", 0.5, "accelerometer_bias_m_s2", (0.0, 0.5, 0.0)),
        ("SIM_ACC1_BIAS_Z", 0.5, "accelerometer_bias_m_s2", (0.0, 0.0, 0.5)),
        ("SIM_GYR1_BIAS_X", 0.5, "gyro_bias_rad_s", (0.5, 0.0, 0.0)),
        ("SIM_GYR1_BIAS_Y", 0.5, "gyro_bias_rad_s", (0.0, 0.5, 0.0)),
        ("SIM_GYR1_BIAS_Z", 0.5, "gyro_bias_rad_s", (0.0, 0.0, 0.5)),
        ("SIM_MAG1_OFS_X", 125, "field_offset_gauss", (0.125, 0.0, 0.0)),
        ("SIM_MAG1_OFS_Y", 125, "field_offset_gauss", (0.0, 0.125, 0.0)),
        ("SIM_MAG1_OFS_Z", 125, "field_offset_gauss", (0.0, 0.0, 0.125)),
        ("SIM_MAG1_FAIL", 1, "compass", SensorState.SILENT),
        ("SIM_BARO_DISABLE", 1, "baro", SensorState.SILENT),
        ("SIM_BARO_FREEZE", 1, "baro", SensorState.STUCK),
        ("SIM_BARO_GLITCH", 12, "baro_offset_m", 12.0),
        ("SIM_BARO_DRIFT", 2, "baro_drift_m_s", 2.0),
        ("SIM_ENGINE_FAIL", 4, "efficiencies", (1.0, 1.0, 0.0, 1.0)),
        ("SIM_WIND_TURB", 1.5, "gust_m_s", 1.5),
        ("SIM_BATT_VOLTAGE", 10.5, "resting_v", 10.5),
    ],
)
@pytest.mark.parametrize("flavour", list(Flavour))
def test_each_parameter_is_a_fault_of_its_own(
    flavour: Flavour, name: str, value: float, field: str, expected: Vector | float | SensorState
) -> None:
    store = default_parameters(flavour)
    faults = Faults(store)
    before = faults.conditions
    # The compass knows a field of the vehicle itself already.
    store.set(name, value + (store[name] if name.startswith("SIM_MAG1_OFS") else 0.0))
    assert faults.advance(1.0, armed=False, flying=False)
    changed = {key: now for key, now in faults.conditions._asdict().items() if now != before._asdict()[key]}
    assert changed == {field: pytest.approx(expected) if not isinstance(expected, SensorState) else expected}
    store.set(name, store.definition(name).default)
    assert faults.advance(2.0, armed=False, flying=False)
    assert faults.conditions == before


def test_the_radio_sends_what_is_scheduled_and_can_be_lost() -> None:
    faults = at(faults_of("radio, channel: 3, pulse_us: 940, at_s: 1, for_s: 2", "radio_loss, at_s: 4"), 0)
    piloted = faults.conditions.radio_us
    assert at(faults, 2.0).conditions.radio_us == (*piloted[:2], 940.0, *piloted[3:])
    assert at(faults, 3.5).conditions.radio_us == piloted
    assert not faults.conditions.radio_lost
    assert at(faults, 4.5).conditions.radio_lost
    store = default_parameters(Flavour.PX4)
    assert Faults(store).conditions.radio_us == ()
    sent = at(Faults(store, schedule_of("radio, channel: 5, pulse_us: 1000")), 1.0).conditions.radio_us
    assert sent[4] == 1000.0


def test_wind_by_parameter_may_blow_upwards_and_weak_motors_share_a_factor() -> None:
    store = default_parameters(Flavour.ARDUPILOT)
    faults = Faults(store)
    for name, value in (("SIM_WIND_SPD", 4), ("SIM_WIND_DIR", 270), ("SIM_WIND_DIR_Z", 30)):
        store.set(name, value)
    store.set("SIM_ENGINE_FAIL", 3)
    store.set("SIM_ENGINE_MUL", 0.75)
    at(faults, 1.0)
    assert faults.conditions.wind_ned_m_s == pytest.approx((0.0, 4.0 * 3**0.5 / 2.0, -2.0), abs=1e-6)
    assert faults.conditions.efficiencies == (0.75, 0.75, 1.0, 1.0)


def test_faults_add_up_and_commands_have_the_last_word() -> None:
    faults = faults_of("wind, north_m_s: 3", "wind, north_m_s: 2, east_m_s: 1", "motor, rotor: 1, efficiency: 0.5")
    at(faults, 1.0)
    assert faults.conditions.wind_ned_m_s == pytest.approx((5.0, 1.0, 0.0))
    assert faults.inject(FailureUnit.MOTOR, FailureType.OFF, 2)
    assert at(faults, 1.05).conditions.efficiencies == (0.5, 0.0, 1.0, 1.0)
    assert faults.inject(FailureUnit.MOTOR, FailureType.OK, 0)
    assert at(faults, 1.1).conditions.efficiencies == (0.5, 1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("unit", "how", "instance", "known"),
    [
        (FailureUnit.GPS, FailureType.OFF, 0, True),
        (FailureUnit.GPS, FailureType.STUCK, 1, True),
        (FailureUnit.GPS, FailureType.OFF, 2, False),
        (FailureUnit.MOTOR, FailureType.STUCK, 1, False),
        (FailureUnit.MOTOR, FailureType.OFF, 5, False),
        (FailureUnit.BATTERY, FailureType.STUCK, 1, False),
        (FailureUnit.BATTERY, FailureType.OFF, 1, True),
    ],
)
def test_only_what_the_vehicle_has_can_fail(unit: FailureUnit, how: FailureType, instance: int, *, known: bool) -> None:
    faults = faults_of()
    before = faults.conditions
    assert faults.inject(unit, how, instance) is known
    assert (at(faults, 1.0).conditions != before) is known
    faults.inject(unit, FailureType.OK, instance)
    assert at(faults, 2.0).conditions == before


def test_nothing_is_wrong_by_default_but_the_lag_that_every_receiver_has() -> None:
    now = faults_of().conditions
    assert now._replace(gps_lag_s=0.0, resting_v=SOUND.resting_v, radio_us=()) == SOUND
    assert len(now.radio_us) == 16
