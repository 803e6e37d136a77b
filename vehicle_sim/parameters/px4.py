"""PX4's parameters, by its names, units and defaults; only those that the vehicle really obeys."""

from typing import Final

from vehicle_sim.parameters.store import Parameter, ParameterKind

_INT, _REAL = ParameterKind.INT32, ParameterKind.REAL32

PX4: Final = (
    Parameter("MAV_SYS_ID", _INT, 1, 1, 250, "system id of this vehicle"),
    Parameter("COM_OF_LOSS_T", _REAL, 1.0, 0, 60, "silence of offboard setpoints that counts as their loss, s"),
    Parameter(
        "COM_OBL_RC_ACT",
        _INT,
        0,
        0,
        7,
        "on loss of offboard: 0 position, 1 altitude, 2 manual, 3 return, 4 land, 5 hold, 6 terminate, 7 disarm",
    ),
    Parameter("COM_DL_LOSS_T", _INT, 10, 5, 300, "silence of the ground station that counts as its loss, s"),
    Parameter(
        "NAV_DLL_ACT",
        _INT,
        0,
        0,
        6,
        "on loss of the ground station: 0 nothing, 1 hold, 2 return, 3 land, 5 terminate, 6 disarm",
    ),
    Parameter("COM_FAIL_ACT_T", _REAL, 5, 0, 25, "hold before the action of a failsafe begins, s"),
    Parameter("COM_DISARM_LAND", _REAL, 2, -1, 20, "landed for so long: disarm, s; not above 0 never"),
    Parameter("COM_DISARM_PRFLT", _REAL, 10, -1, 60, "armed and not flown for so long: disarm, s; not above 0 never"),
    Parameter("COM_SPOOLUP_TIME", _REAL, 1, 0, 30, "from arming until the motors may lift, s"),
    Parameter("COM_LOW_BAT_ACT", _INT, 0, 0, 3, "on a critical battery: 0 warn, 2 land, 3 return, land if emergency"),
    Parameter("BAT_LOW_THR", _REAL, 0.15, 0.12, 0.5, "charge left that counts as low, share of the capacity"),
    Parameter("BAT_CRIT_THR", _REAL, 0.07, 0.05, 0.5, "charge left that counts as critical, share of the capacity"),
    Parameter("BAT_EMERGEN_THR", _REAL, 0.05, 0.03, 0.5, "charge left that counts as an emergency, share"),
    Parameter("BAT1_CAPACITY", _REAL, 5000, 100, 100000, "capacity of a full battery, mAh"),
    Parameter("COM_POS_FS_EPH", _REAL, 5, -1, 400, "horizontal deviation that counts as failure, m; below 0 never"),
    Parameter("MPC_TILTMAX_AIR", _REAL, 45, 20, 89, "largest tilt, degrees"),
    Parameter("MPC_YAWRAUTO_MAX", _REAL, 60, 5, 360, "largest yaw rate that a mode asks for, degrees/s"),
    Parameter("MPC_XY_CRUISE", _REAL, 5, 3, 20, "horizontal speed of automatic modes, m/s"),
    Parameter("MPC_XY_VEL_MAX", _REAL, 12, 0.5, 20, "largest horizontal speed, m/s"),
    Parameter("MPC_Z_V_AUTO_UP", _REAL, 3, 0.5, 8, "climb speed of automatic modes, m/s"),
    Parameter("MPC_Z_V_AUTO_DN", _REAL, 1.5, 0.5, 4, "descent speed of automatic modes, m/s"),
    Parameter("MPC_ACC_HOR", _REAL, 3, 2, 15, "horizontal acceleration of automatic modes, m/s^2"),
    Parameter("MPC_ACC_HOR_MAX", _REAL, 5, 2, 15, "largest horizontal acceleration, m/s^2"),
    Parameter("MPC_ACC_UP_MAX", _REAL, 4, 2, 15, "largest vertical acceleration, m/s^2"),
    Parameter("MPC_TKO_SPEED", _REAL, 1.5, 1, 5, "climb speed of a take-off, m/s"),
    Parameter("MPC_LAND_SPEED", _REAL, 0.7, 0.6, 5, "speed of the last part of a landing, m/s"),
    Parameter("MPC_LAND_ALT1", _REAL, 10, 0, 122, "height above home where a landing slows down, m"),
    Parameter("MIS_TAKEOFF_ALT", _REAL, 2.5, 0, 80, "height of a take-off that names none, m"),
    Parameter("MIS_DIST_1WP", _REAL, 10000, -1, 100000, "farthest first place of a mission, m; not above 0 any"),
    Parameter(
        "MIS_TKO_LAND_REQ", _INT, 0, 0, 4, "missions need: 0 nothing, 1 take-off, 2 landing, 3 both, 4 both or none"
    ),
    Parameter("NAV_ACC_RAD", _REAL, 2, 0.05, 200, "distance that counts as having reached a waypoint, m"),
    Parameter("NAV_MC_ALT_RAD", _REAL, 0.8, 0.05, 200, "difference of height that counts as having reached it, m"),
    Parameter("MPC_YAW_MODE", _INT, 0, 0, 3, "missions look: 0 at the waypoint, 1 home, 2 away from home, 3 ahead"),
    Parameter("RTL_RETURN_ALT", _REAL, 60, 0, 150, "height above home of the way back, m"),
    Parameter("RTL_DESCEND_ALT", _REAL, 30, 0, 150, "height above home where the descent pauses, m"),
    Parameter("RTL_LAND_DELAY", _REAL, 0, -1, 300, "wait over home before landing, s; below 0 stay there"),
    Parameter("RTL_MIN_DIST", _REAL, 10, 0.5, 100, "closer to home than this: no climb for the return, m"),
    Parameter("SIM_WIND_SPD", _REAL, 0, 0, 30, "speed of the steady wind, m/s"),
    Parameter("SIM_WIND_DIR", _REAL, 180, 0, 360, "direction that the wind comes from, degrees"),
    Parameter("SIM_WIND_TURB", _REAL, 0, 0, 10, "standard deviation of the gusts, m/s"),
)
