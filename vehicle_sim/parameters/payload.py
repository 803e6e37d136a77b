"""Parameters of the camera and of its mount, by the names, units and defaults of each flavour.

Both autopilots come without a camera (CAM1_TYPE and TRIG_MODE are 0); this vehicle has one.
"""

from typing import Final

from vehicle_sim.parameters.store import Parameter, ParameterKind

_I8, _I16, _I32, _REAL = ParameterKind.INT8, ParameterKind.INT16, ParameterKind.INT32, ParameterKind.REAL32

ARDUPILOT_PAYLOAD: Final = (
    Parameter("CAM1_TYPE", _I8, 1, 0, 1, "camera: 0 none, 1 one with a servo on its shutter; from the next boot on"),
    Parameter("CAM1_TRIGG_DIST", _REAL, 0, 0, 1000, "a picture each time that it has come so far, m; 0 never"),
    Parameter("CAM1_INTRVAL_MIN", _REAL, 0, 0, 10, "least time between two pictures, s"),
    Parameter("CAM_AUTO_ONLY", _I8, 0, 0, 1, "1: pictures by distance are taken in AUTO alone"),
    Parameter("CAM_MAX_ROLL", _I16, 0, 0, 180, "no picture by distance beyond this roll, degrees; 0 none is too much"),
    Parameter("MNT1_TYPE", _I8, 1, 0, 1, "mount: 0 none, 1 one that takes commands and looks straight down"),
)
PX4_PAYLOAD: Final = (
    Parameter(
        "TRIG_MODE", _I32, 4, 0, 4, "camera: 0 none; by time 1 if told, 2 always; by distance 3 always, 4 if told"
    ),
    Parameter("TRIG_DISTANCE", _REAL, 25, 0, 1000, "a picture each time that it has come so far, m"),
    Parameter("TRIG_INTERVAL", _REAL, 40, 4, 10000, "time between pictures by time, ms"),
    Parameter("TRIG_MIN_INTERVA", _REAL, 1, 1, 10000, "least time between two pictures, ms"),
    Parameter("MNT_MODE_IN", _I32, 4, -1, 4, "mount: -1 none, else one that takes commands and looks straight down"),
)
