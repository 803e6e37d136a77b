"""What is wrong now: one value, which the parts of the vehicle and its world suffer."""

from enum import Enum, auto
from math import nan
from typing import Final, NamedTuple

from vehicle_sim.dynamics.wind import blowing_from
from vehicle_sim.parameters import Flavour, ParameterStore
from vehicle_sim.signals import FourRotors, Vector

ROTORS: Final = 4
_SOUND: Final[FourRotors] = (1.0, 1.0, 1.0, 1.0)
_NONE: Final[Vector] = (0.0, 0.0, 0.0)
_GAUSS: Final = 1e-3


class SensorState(Enum):
    """Whether a sensor gives readings: fresh ones, none, or its last one again and again."""

    WORKING = auto()
    SILENT = auto()
    STUCK = auto()


class Conditions(NamedTuple):
    """The state of the world and of the parts; everything at its default is a sound vehicle in still air.

    `gps_glitch` is in degrees of latitude and longitude and metres of altitude; `gps_offset_ned_m` is the same in
    metres. A drift grows as long as it lasts, and its velocity is that of the fix, too: the receiver follows a wrong
    signal. Biases are in body axes. Rotors are 1 front, 2 right, 3 rear,
    4 left. `resting_v` is what the battery was last said to rest at. `radio_us` are the pulses of the radio's
    transmitter from channel 1 on, in microseconds, not a number where its pilot does what is fit; empty where there is
    none.
    """

    wind_ned_m_s: Vector = _NONE
    gust_m_s: float = 0.0
    gps: SensorState = SensorState.WORKING
    gps_glitch: Vector = _NONE
    gps_offset_ned_m: Vector = _NONE
    gps_drift_ned_m_s: Vector = _NONE
    gps_velocity_error_ned_m_s: Vector = _NONE
    gps_noise_m: float = 0.0
    gps_lag_s: float = 0.0
    gps_satellites: int = 10
    accelerometer_bias_m_s2: Vector = _NONE
    gyro_bias_rad_s: Vector = _NONE
    compass: SensorState = SensorState.WORKING
    field_offset_gauss: Vector = _NONE
    baro: SensorState = SensorState.WORKING
    baro_offset_m: float = 0.0
    baro_drift_m_s: float = 0.0
    efficiencies: FourRotors = _SOUND
    resting_v: float = 12.6
    radio_us: tuple[float, ...] = ()
    radio_lost: bool = False


PILOTED_US: Final = (1500.0, 1500.0, nan, 1500.0, 1800.0, 1000.0, 1000.0, 1800.0, *(1500.0,) * 8)
"""What a transmitter sends by which nobody flies: the channels of ArduPilot's simulator."""

_NO_PULSES, _NEUTRAL = 1, 2
_NEUTRAL_US: Final = (1500.0, 1500.0, 950.0, *(1500.0,) * 13)

SOUND: Final = Conditions()
"""Nothing is wrong."""


def _vector(store: ParameterStore, stem: str) -> Vector:
    return store[f"{stem}_X"], store[f"{stem}_Y"], store[f"{stem}_Z"]


def conditions_of(store: ParameterStore) -> Conditions:
    """Return what the parameters say is wrong."""
    weak, share = int(store["SIM_ENGINE_FAIL"]), store["SIM_ENGINE_MUL"]
    first, second, third, fourth = (share if weak >> rotor & 1 else 1.0 for rotor in range(ROTORS))
    field = _vector(store, "SIM_MAG1_OFS")
    # ArduPilot's compass is calibrated: COMPASS_OFS take away what of it is known.
    known = _vector(store, "COMPASS_OFS") if store.flavour is Flavour.ARDUPILOT else _NONE
    has_gps = store["SIM_GPS1_ENABLE"] and not store["SIM_GPS_DISABLE"]
    baro = SensorState.STUCK if store["SIM_BARO_FREEZE"] else SensorState.WORKING
    return Conditions(
        wind_ned_m_s=blowing_from(store["SIM_WIND_SPD"], store["SIM_WIND_DIR"], store["SIM_WIND_DIR_Z"]),
        gust_m_s=store["SIM_WIND_TURB"],
        gps=SensorState.WORKING if has_gps else SensorState.SILENT,
        gps_glitch=_vector(store, "SIM_GPS1_GLTCH"),
        gps_velocity_error_ned_m_s=_vector(store, "SIM_GPS1_VERR"),
        gps_noise_m=store["SIM_GPS1_NOISE"],
        gps_lag_s=store["SIM_GPS1_LAG_MS"] / 1000.0,
        gps_satellites=int(store["SIM_GPS1_NUMSATS"]),
        accelerometer_bias_m_s2=_vector(store, "SIM_ACC1_BIAS"),
        gyro_bias_rad_s=_vector(store, "SIM_GYR1_BIAS"),
        compass=SensorState.SILENT if store["SIM_MAG1_FAIL"] else SensorState.WORKING,
        field_offset_gauss=(
            (field[0] - known[0]) * _GAUSS,
            (field[1] - known[1]) * _GAUSS,
            (field[2] - known[2]) * _GAUSS,
        ),
        baro=SensorState.SILENT if store["SIM_BARO_DISABLE"] else baro,
        baro_offset_m=store["SIM_BARO_GLITCH"],
        baro_drift_m_s=store["SIM_BARO_DRIFT"],
        efficiencies=(first, second, third, fourth),
        resting_v=store["SIM_BATT_VOLTAGE"],
        radio_us=_radio(store),
    )


def _radio(store: ParameterStore) -> tuple[float, ...]:
    """Return what the transmitter sends: as PX4 there is none until a fault sets a channel."""
    failed = _NO_PULSES if store.flavour is Flavour.PX4 else int(store["SIM_RC_FAIL"])
    if failed == _NO_PULSES:
        return ()
    return _NEUTRAL_US if failed == _NEUTRAL else PILOTED_US
