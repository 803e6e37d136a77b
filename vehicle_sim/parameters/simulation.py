"""Parameters of the simulated world, by the names of ArduPilot's simulator: what is wrong with sensors and motors.

PX4 has none of them; both flavours take them here, because faults are the simulation's and not the autopilot's. Units
are ArduPilot's (`libraries/SITL/SITL.cpp`): glitches are offsets of latitude and longitude in degrees.
"""

from typing import Final

from vehicle_sim.parameters.store import Parameter, ParameterKind

_I8, _I16, _I32, _REAL = ParameterKind.INT8, ParameterKind.INT16, ParameterKind.INT32, ParameterKind.REAL32

_AXES: Final = ("X", "Y", "Z")
_WORLD: Final = (
    Parameter("SIM_WIND_DIR_Z", _REAL, 0, -90, 90, "angle by which the steady wind blows upwards, degrees"),
    Parameter("SIM_GPS1_ENABLE", _I8, 1, 0, 1, "whether the receiver is connected"),
    Parameter("SIM_GPS_DISABLE", _I8, 0, 0, 1, "whether the receiver is disconnected: the older name"),
    Parameter("SIM_GPS1_GLTCH_X", _REAL, 0, -1, 1, "error of the fix's latitude, degrees"),
    Parameter("SIM_GPS1_GLTCH_Y", _REAL, 0, -1, 1, "error of the fix's longitude, degrees"),
    Parameter("SIM_GPS1_GLTCH_Z", _REAL, 0, -1000, 1000, "error of the fix's altitude, m"),
    Parameter("SIM_GPS1_LAG_MS", _I16, 100, 0, 1000, "time from a fix to its arrival, ms"),
    Parameter("SIM_GPS1_NUMSATS", _I8, 10, 0, 30, "satellites in view; fewer than 4 make no fix"),
    Parameter("SIM_GPS1_NOISE", _REAL, 0, 0, 100, "deviation of noise added to the fix's altitude and place, m"),
    *(Parameter(f"SIM_GPS1_VERR_{axis}", _REAL, 0, -20, 20, "error of the fix's velocity, m/s") for axis in _AXES),
    *(Parameter(f"SIM_ACC1_BIAS_{axis}", _REAL, 0, -5, 5, "bias of the accelerometer, m/s^2") for axis in _AXES),
    *(Parameter(f"SIM_GYR1_BIAS_{axis}", _REAL, 0, -1, 1, "bias of the gyro, rad/s") for axis in _AXES),
    *(
        Parameter(f"SIM_MAG1_OFS_{axis}", _REAL, 0, -1000, 1000, "field of the vehicle itself, mGauss")
        for axis in _AXES
    ),
    Parameter("SIM_MAG1_FAIL", _I8, 0, 0, 1, "whether the compass is dead"),
    Parameter("SIM_BARO_DISABLE", _I8, 0, 0, 1, "whether the barometer is dead"),
    Parameter("SIM_BARO_FREEZE", _I8, 0, 0, 1, "whether the barometer repeats its last reading"),
    Parameter("SIM_BARO_GLITCH", _REAL, 0, -1000, 1000, "error of the barometric altitude, m"),
    Parameter("SIM_BARO_DRIFT", _REAL, 0, -10, 10, "growth of the error of the barometric altitude, m/s"),
    Parameter("SIM_ENGINE_FAIL", _I32, 0, 0, 15, "weak motors, one bit each: 1 front, 2 right, 4 rear, 8 left"),
    Parameter("SIM_ENGINE_MUL", _REAL, 0, 0, 1, "thrust of the weak motors as a share of a sound one's"),
    Parameter(
        "SIM_BATT_VOLTAGE", _REAL, 12.6, 0, 12.6, "resting voltage; a change sets the charge that belongs to it, V"
    ),
)


def _widened(parameter: Parameter) -> Parameter:
    kind = parameter.kind if parameter.kind is ParameterKind.REAL32 else ParameterKind.INT32
    return Parameter(parameter.name, kind, parameter.default, parameter.minimum, parameter.maximum, parameter.meaning)


ARDUPILOT_SIMULATION: Final = _WORLD
"""With the storage sizes of ArduPilot."""

PX4_SIMULATION: Final = (
    *(_widened(parameter) for parameter in _WORLD),
    Parameter("SYS_FAILURE_EN", ParameterKind.INT32, 0, 0, 1, "whether failures may be injected by command"),
)
"""The same; PX4 stores whole numbers in 32 bits."""
