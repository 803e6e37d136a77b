"""ArduCopter's parameters, by its names, units and defaults; only those that the vehicle really obeys."""

from typing import Final

from vehicle_sim.parameters.store import Parameter, ParameterKind

_I8, _I16, _I32, _REAL = ParameterKind.INT8, ParameterKind.INT16, ParameterKind.INT32, ParameterKind.REAL32

_STREAMS: Final = {
    "RAW_SENS": "the inertial unit and pressure",
    "EXT_STAT": "health, receiver and mission",
    "RC_CHAN": "channels and outputs",
    "POSITION": "position",
    "EXTRA1": "attitude",
    "EXTRA2": "what a head-up display shows",
    "EXTRA3": "battery, estimator and time",
}

ARDUPILOT: Final = (
    Parameter("MAV_SYSID", _I16, 1, 1, 255, "system id of this vehicle, from the next boot on"),
    Parameter("MAV_GCS_SYSID", _I16, 255, 1, 255, "system id of the ground station whose heartbeats count"),
    Parameter("FS_GCS_ENABLE", _I8, 0, 0, 7, "on loss of the ground station: 0 nothing, 1 return, 5 land, 7 brake"),
    Parameter("FS_GCS_TIMEOUT", _REAL, 5, 2, 120, "silence of the ground station that counts as its loss, s"),
    Parameter("FS_EKF_ACTION", _I8, 1, 0, 3, "on failure of the estimator: 0 nothing, 1 land, 2 hold height, 3 land"),
    Parameter("FS_EKF_THRESH", _REAL, 0.8, 0, 1, "test ratio of the estimator that counts as its failure"),
    Parameter("FS_THR_ENABLE", _I8, 1, 0, 7, "on loss of the sticks: 0 nothing, 1 return, 3 land, 7 brake"),
    Parameter("RC_FS_TIMEOUT", _REAL, 1, 0.5, 10, "silence of sticks that have been there that counts as loss, s"),
    Parameter("GUID_TIMEOUT", _REAL, 3, 0.1, 5, "silence of velocity or acceleration setpoints before a stop, s"),
    Parameter("GUID_OPTIONS", _I32, 0, 0, 255, "bit 3: the thrust of attitude targets is thrust, not a climb rate"),
    Parameter("DISARM_DELAY", _I8, 10, 0, 127, "landed and idle for so long: disarm, s; 0 never"),
    # Of the checks that can be skipped the vehicle has one; position, mode, fence and failsafes are always checked.
    Parameter("ARMING_SKIPCHK", _I32, 0, -1, 2097151, "checks before arming that are skipped: bit 8 battery; -1 all"),
    Parameter("ARMING_DELAY_SEC", _REAL, 2, 0, 5, "from arming until the motors may lift, s"),
    Parameter("ANGLE_MAX", _I16, 3000, 1000, 8000, "largest tilt, centidegrees"),
    Parameter("ATC_SLEW_YAW", _REAL, 6000, 500, 18000, "largest yaw rate that a mode asks for, centidegrees/s"),
    Parameter("WPNAV_SPEED", _REAL, 1000, 10, 2000, "horizontal speed between waypoints, cm/s"),
    Parameter("WPNAV_SPEED_UP", _REAL, 250, 10, 1000, "climb speed, cm/s"),
    Parameter("WPNAV_SPEED_DN", _REAL, 150, 10, 500, "descent speed, cm/s"),
    Parameter("WPNAV_ACCEL", _REAL, 250, 50, 500, "horizontal acceleration, cm/s^2"),
    Parameter("WPNAV_ACCEL_Z", _REAL, 100, 50, 500, "vertical acceleration, cm/s^2"),
    Parameter("WPNAV_RADIUS", _REAL, 200, 5, 1000, "distance that counts as having reached home or a waypoint, cm"),
    Parameter("WP_YAW_BEHAVIOR", _I8, 2, 0, 3, "a mission's legs: 0 keep the heading, 1 to 3 look ahead"),
    Parameter("CIRCLE_RADIUS", _REAL, 1000, 0, 200000, "radius of a mission's circles that name none, cm"),
    Parameter("CIRCLE_RATE", _REAL, 20, -90, 90, "greatest rate on a mission's circles, degrees/s"),
    Parameter("MIS_RESTART", _I8, 0, 0, 1, "on entering AUTO: 0 the mission is resumed, 1 it starts anew"),
    Parameter("AUTO_OPTIONS", _I32, 0, 0, 255, "in AUTO: bit 0 allows arming, bit 1 the take-off without a command"),
    Parameter("LAND_SPEED", _I16, 50, 30, 200, "speed of the last part of a landing, cm/s"),
    Parameter("LAND_SPEED_HIGH", _I16, 0, 0, 500, "speed of the first part of a landing, cm/s; 0 is WPNAV_SPEED_DN"),
    Parameter("LAND_ALT_LOW", _I16, 1000, 100, 10000, "height above home where the last part begins, cm"),
    Parameter("RTL_ALT", _I32, 1500, 30, 300000, "height above home of the way back, cm"),
    Parameter("RTL_SPEED", _I16, 0, 0, 2000, "speed of the way back, cm/s; 0 is WPNAV_SPEED"),
    Parameter("RTL_LOIT_TIME", _I32, 5000, 0, 60000, "wait over home before the descent, ms"),
    Parameter("RTL_CONE_SLOPE", _REAL, 3, 0, 10, "near home: climb no higher than slope x distance; 0 no cone"),
    Parameter("RTL_CLIMB_MIN", _I16, 0, 0, 3000, "least climb at the start of a return, cm"),
    Parameter("BATT_CAPACITY", _I32, 5000, 100, 100000, "capacity of a full battery, mAh"),
    Parameter("BATT_LOW_VOLT", _REAL, 10.5, 0, 60, "voltage that counts as low, V; 0 never"),
    Parameter("BATT_CRT_VOLT", _REAL, 0, 0, 60, "voltage that counts as critical, V; 0 never"),
    Parameter("BATT_LOW_MAH", _REAL, 0, 0, 100000, "charge left that counts as low, mAh; 0 never"),
    Parameter("BATT_CRT_MAH", _REAL, 0, 0, 100000, "charge left that counts as critical, mAh; 0 never"),
    Parameter("BATT_LOW_TIMER", _I8, 10, 0, 120, "how long the voltage must be low, s"),
    Parameter("BATT_FS_LOW_ACT", _I8, 0, 0, 5, "on a low battery: 0 warn, 1 land, 2 return, 5 terminate"),
    Parameter("BATT_FS_CRT_ACT", _I8, 0, 0, 5, "on a critical battery: 0 warn, 1 land, 2 return, 5 terminate"),
    Parameter("LOIT_SPEED", _REAL, 1250, 20, 3500, "horizontal speed by full stick in LOITER, cm/s"),
    Parameter("PILOT_SPEED_UP", _I16, 250, 50, 500, "climb speed by full stick, cm/s"),
    Parameter("PILOT_SPEED_DN", _I16, 0, 0, 500, "descent speed by full stick, cm/s; 0 is PILOT_SPEED_UP"),
    Parameter("PILOT_Y_RATE", _REAL, 202.5, 1, 360, "yaw rate by full stick, degrees/s"),
    Parameter("THR_DZ", _I16, 100, 0, 300, "dead zone about the middle of the throttle stick, of 1000"),
    Parameter("RC_OVERRIDE_TIME", _REAL, 3, -1, 120, "sticks by MAVLink count for so long, s; 0 never, -1 for ever"),
    Parameter("RCMAP_ROLL", _I8, 1, 1, 16, "channel of the roll stick"),
    Parameter("RCMAP_PITCH", _I8, 2, 1, 16, "channel of the pitch stick"),
    Parameter("RCMAP_THROTTLE", _I8, 3, 1, 16, "channel of the throttle stick"),
    Parameter("RCMAP_YAW", _I8, 4, 1, 16, "channel of the yaw stick"),
    Parameter("FRAME_CLASS", _I8, 1, 1, 1, "kind of frame: 1 is a quadrotor", read_only=True),
    *(
        Parameter(
            f"MAV{number}_{name}", _I16, 0, 0, 50, f"unasked rate of {what} on {links}, from the next boot on, Hz"
        )
        for number, links in ((1, "links that are waited on or called"), (2, "the link to the ground station"))
        for name, what in _STREAMS.items()
    ),
    Parameter("FENCE_ENABLE", _I8, 0, 0, 1, "whether the fence is watched"),
    Parameter("FENCE_TYPE", _I8, 7, 0, 7, "kinds of fence: bit 0 ceiling, 1 circle around home, 2 uploaded areas"),
    Parameter("FENCE_ACTION", _I8, 1, 0, 5, "on a breach: 0 report, 1 return, 2 land, 3 return, 4 brake, 5 land"),
    Parameter("FENCE_ALT_MAX", _REAL, 100, 10, 1000, "ceiling above home, m"),
    Parameter("FENCE_RADIUS", _REAL, 300, 30, 10000, "radius of the circle around home, m"),
    Parameter("FENCE_MARGIN", _REAL, 2, 1, 10, "how far inside of the fence automatic flight stays, m"),
    Parameter("FENCE_OPTIONS", _I16, 1, 0, 3, "bit 0: no change of mode until a breach is over, 1: areas add up"),
    Parameter("AVOID_ENABLE", _I8, 3, 0, 7, "bit 0: velocity setpoints end at the margin of the fence"),
    Parameter("RALLY_LIMIT_KM", _REAL, 0.3, 0, 100, "rally points further away are left out, km; 0 none is"),
    Parameter("RALLY_INCL_HOME", _I8, 1, 0, 1, "whether home competes with the rally points"),
    Parameter("SIM_WIND_SPD", _REAL, 0, 0, 30, "speed of the steady wind, m/s"),
    Parameter("SIM_WIND_DIR", _REAL, 180, 0, 360, "direction that the wind comes from, degrees"),
    Parameter("SIM_WIND_TURB", _REAL, 0, 0, 10, "standard deviation of the gusts, m/s"),
)
