"""One set of flight settings in SI units, whichever autopilot's parameters they are read from."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, auto
from math import inf, radians
from typing import Final

from vehicle_sim.parameters.actions import Action
from vehicle_sim.parameters.hand import PX4_LINK_LOSS, HandSettings, hand_settings
from vehicle_sim.parameters.protection import (
    NO_WIND_LIMIT,
    FenceSettings,
    RallySettings,
    WindSettings,
    ardupilot_fence,
    ardupilot_rally,
    px4_fence,
    px4_rally,
    px4_wind,
)
from vehicle_sim.parameters.store import Flavour, ParameterStore
from vehicle_sim.signals import Limits


class YawBehaviour(Enum):
    """Where a vehicle that flies by itself looks, unless it is told."""

    KEEP = auto()
    AHEAD = auto()
    TO_HOME = auto()
    FROM_HOME = auto()


@dataclass(frozen=True, slots=True, kw_only=True)
class BatteryThresholds:
    """Where a battery becomes low, critical, an emergency: by voltage and by the share of charge left; 0 is never."""

    capacity_mah: float
    low_v: float
    critical_v: float
    voltage_time_s: float
    low_share: float
    critical_share: float
    emergency_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightSettings:
    """What the autopilot and the controller go by; metres, seconds, radians. Infinity means never."""

    ground_system_id: int | None
    setpoint_timeout_s: float
    setpoint_loss: Action
    thrust_climbs: bool
    ground_timeout_s: float
    ground_loss: Action
    estimator_loss: Action
    estimator_accuracy_m: float
    estimator_ratio: float
    estimator_in_manual: bool
    failsafe_hold_s: float
    battery_low: Action
    battery_critical: Action
    battery_emergency: Action
    battery_thresholds: BatteryThresholds
    battery_checked: bool
    lift_off_s: float
    disarm_landed_s: float
    disarm_unflown_s: float
    tilt_rad: float
    yaw_rate_rad_s: float
    cruise_m_s: float
    setpoint_speed_m_s: float
    setpoint_acceleration_m_s2: float
    reached_m: float
    climb_m_s: float
    descent_m_s: float
    acceleration_m_s2: float
    braking_m_s2: float
    reaction_s: float
    arrival_per_s: float
    vertical_acceleration_m_s2: float
    takeoff_m_s: float
    takeoff_height_m: float
    landing_heights_m: tuple[float, ...]
    landing_m_s: tuple[float, ...]
    return_height_m: float
    return_speed_m_s: float
    return_wait_s: float
    return_descent_height_m: float
    return_cone_slope: float
    return_climb_min_m: float
    return_min_distance_m: float
    path_accuracy_m: float
    path_places: int
    hand: HandSettings
    fence: FenceSettings
    rally: RallySettings
    wind: WindSettings
    accept_m: float
    accept_height_m: float
    yaw_behaviour: YawBehaviour
    circle_radius_m: float
    circle_rate_rad_s: float
    mission_restarts: bool
    mission_arms: bool
    mission_lifts: bool
    mission_farthest_m: float
    mission_needs_takeoff: bool
    mission_needs_landing: bool
    mission_needs_both_or_none: bool

    def limits(self) -> Limits:
        """Return the limits of automatic flight before any mode or command narrows them."""
        return Limits(
            speed_m_s=self.cruise_m_s,
            climb_m_s=self.climb_m_s,
            descent_m_s=self.descent_m_s,
            acceleration_m_s2=self.acceleration_m_s2,
            braking_m_s2=self.braking_m_s2,
            vertical_acceleration_m_s2=self.vertical_acceleration_m_s2,
            tilt_rad=self.tilt_rad,
            yaw_rate_rad_s=self.yaw_rate_rad_s,
        )


_GROUND_LOSS: Final[Mapping[int, Action]] = {
    1: Action.RETURN,
    2: Action.RETURN,
    3: Action.RETRACE,
    4: Action.RETRACE_OR_LAND,
    5: Action.LAND,
    6: Action.RETURN,
    7: Action.BRAKE,
}
_ESTIMATOR_LOSS: Final[Mapping[int, Action]] = {1: Action.LAND, 2: Action.ALTITUDE, 3: Action.LAND}
_EVEN_IN_MANUAL: Final = 3
_BATTERY: Final[Mapping[int, Action]] = {
    1: Action.LAND,
    2: Action.RETURN,
    3: Action.RETRACE,
    4: Action.RETRACE_OR_LAND,
    5: Action.TERMINATE,
}
_OFFBOARD_LOSS: Final[Mapping[int, Action]] = {
    0: Action.POSITION,
    1: Action.ALTITUDE,
    2: Action.MANUAL,
    3: Action.RETURN,
    4: Action.LAND,
    5: Action.HOLD,
    6: Action.TERMINATE,
    7: Action.DISARM,
}
_LOW_BATTERY: Final[Mapping[int, tuple[Action, Action]]] = {
    2: (Action.LAND, Action.LAND),
    3: (Action.RETURN, Action.LAND),
}


_THRUST_AS_THRUST: Final = 1 << 3
_CHECK_ALL: Final = 1
_CHECK_BATTERY: Final = 1 << 8
_ARMING_DELAY_S: Final = 2.0
"""A constant of ArduCopter's build."""
_CARRYING: Final = 0.435
"""Share of the take-off's throttle that carries the weight."""

_AP_CORRECTING: Final = 1.2
"""What may be asked for on the way to a place: the limit of its planned acceleration, and what corrects errors."""

_AP_BRAKING, _AP_REACTION_S, _AP_ARRIVAL_PER_S = 0.75, 0.8, 0.8
_PX4_BRAKING, _PX4_REACTION_S = 0.7, 0.3
_ALLOW_ARMING: Final = 1
_ALLOW_TAKEOFF: Final = 2
_BOTH_OR_NONE: Final = 4
_AP_YAW: Final[Mapping[int, YawBehaviour]] = {
    0: YawBehaviour.KEEP,
    1: YawBehaviour.AHEAD,
    2: YawBehaviour.AHEAD,
    3: YawBehaviour.AHEAD,
}
_PX4_YAW: Final[Mapping[int, YawBehaviour]] = {
    0: YawBehaviour.AHEAD,
    1: YawBehaviour.TO_HOME,
    2: YawBehaviour.FROM_HOME,
    3: YawBehaviour.AHEAD,
}


def _never_unless_positive(value: float) -> float:
    return value if value > 0.0 else inf


def _from_ardupilot(store: ParameterStore) -> FlightSettings:
    cruise_m_s = store["WPNAV_SPEED"] / 100.0
    climb_m_s, descent_m_s = store["WPNAV_SPEED_UP"] / 100.0, store["WPNAV_SPEED_DN"] / 100.0
    capacity_mah = store["BATT_CAPACITY"]
    critical = _BATTERY.get(int(store["BATT_FS_CRT_ACT"]), Action.NOTHING)
    return FlightSettings(
        ground_system_id=int(store["MAV_GCS_SYSID"]),
        setpoint_timeout_s=store["GUID_TIMEOUT"],
        setpoint_loss=Action.NOTHING,
        thrust_climbs=not int(store["GUID_OPTIONS"]) & _THRUST_AS_THRUST,
        ground_timeout_s=store["FS_GCS_TIMEOUT"],
        ground_loss=_GROUND_LOSS.get(int(store["FS_GCS_ENABLE"]), Action.NOTHING),
        estimator_loss=_ESTIMATOR_LOSS.get(int(store["FS_EKF_ACTION"]), Action.NOTHING),
        estimator_accuracy_m=inf,
        estimator_ratio=_never_unless_positive(store["FS_EKF_THRESH"]),
        estimator_in_manual=store["FS_EKF_ACTION"] == _EVEN_IN_MANUAL,
        failsafe_hold_s=0.0,
        battery_low=_BATTERY.get(int(store["BATT_FS_LOW_ACT"]), Action.NOTHING),
        battery_critical=critical,
        battery_emergency=critical,
        battery_thresholds=BatteryThresholds(
            capacity_mah=capacity_mah,
            low_v=store["BATT_LOW_VOLT"],
            critical_v=store["BATT_CRT_VOLT"],
            voltage_time_s=store["BATT_LOW_TIMER"],
            low_share=store["BATT_LOW_MAH"] / capacity_mah,
            critical_share=store["BATT_CRT_MAH"] / capacity_mah,
            emergency_share=0.0,
        ),
        battery_checked=bool(int(store["ARMING_CHECK"]) & (_CHECK_ALL | _CHECK_BATTERY)),
        # Then the throttle rises, and carries the weight before it is all there.
        lift_off_s=_ARMING_DELAY_S + store["MOT_SPOOL_TIME"] + _CARRYING * store["TKOFF_SLEW_TIME"],
        disarm_landed_s=_never_unless_positive(store["DISARM_DELAY"]),
        disarm_unflown_s=_never_unless_positive(store["DISARM_DELAY"]),
        tilt_rad=radians(store["ANGLE_MAX"] / 100.0),
        yaw_rate_rad_s=radians(store["ATC_SLEW_YAW"] / 100.0),
        cruise_m_s=cruise_m_s,
        setpoint_speed_m_s=cruise_m_s,
        setpoint_acceleration_m_s2=_AP_CORRECTING * store["WPNAV_ACCEL"] / 100.0,
        reached_m=store["WPNAV_RADIUS"] / 100.0,
        climb_m_s=climb_m_s,
        descent_m_s=descent_m_s,
        acceleration_m_s2=store["WPNAV_ACCEL"] / 100.0,
        braking_m_s2=_AP_BRAKING * store["WPNAV_ACCEL"] / 100.0,
        reaction_s=_AP_REACTION_S,
        arrival_per_s=_AP_ARRIVAL_PER_S,
        vertical_acceleration_m_s2=store["WPNAV_ACCEL_Z"] / 100.0,
        takeoff_m_s=climb_m_s,
        takeoff_height_m=0.0,
        landing_heights_m=(store["LAND_ALT_LOW"] / 100.0,) * 2,
        landing_m_s=(store["LAND_SPEED"] / 100.0, store["LAND_SPEED_HIGH"] / 100.0 or descent_m_s),
        return_height_m=store["RTL_ALT"] / 100.0,
        return_speed_m_s=store["RTL_SPEED"] / 100.0 or cruise_m_s,
        return_wait_s=store["RTL_LOIT_TIME"] / 1000.0,
        return_descent_height_m=inf,
        return_cone_slope=_never_unless_positive(store["RTL_CONE_SLOPE"]),
        return_climb_min_m=store["RTL_CLIMB_MIN"] / 100.0,
        return_min_distance_m=0.0,
        path_accuracy_m=store["SRTL_ACCURACY"],
        path_places=int(store["SRTL_POINTS"]),
        hand=hand_settings(store),
        fence=ardupilot_fence(store),
        rally=ardupilot_rally(store),
        wind=NO_WIND_LIMIT,
        accept_m=store["WPNAV_RADIUS"] / 100.0,
        accept_height_m=store["WPNAV_RADIUS"] / 100.0,
        yaw_behaviour=_AP_YAW[int(store["WP_YAW_BEHAVIOR"])],
        circle_radius_m=store["CIRCLE_RADIUS"] / 100.0,
        circle_rate_rad_s=radians(store["CIRCLE_RATE"]),
        mission_restarts=store["MIS_RESTART"] > 0.0,
        mission_arms=bool(int(store["AUTO_OPTIONS"]) & _ALLOW_ARMING),
        mission_lifts=bool(int(store["AUTO_OPTIONS"]) & _ALLOW_TAKEOFF),
        mission_farthest_m=inf,
        mission_needs_takeoff=False,
        mission_needs_landing=False,
        mission_needs_both_or_none=False,
    )


def _from_px4(store: ParameterStore) -> FlightSettings:
    critical, emergency = _LOW_BATTERY.get(int(store["COM_LOW_BAT_ACT"]), (Action.NOTHING, Action.NOTHING))
    accuracy_m, wait_s = store["COM_POS_FS_EPH"], store["RTL_LAND_DELAY"]
    return FlightSettings(
        ground_system_id=None,
        setpoint_timeout_s=store["COM_OF_LOSS_T"],
        setpoint_loss=_OFFBOARD_LOSS[int(store["COM_OBL_RC_ACT"])],
        thrust_climbs=False,
        ground_timeout_s=store["COM_DL_LOSS_T"],
        ground_loss=PX4_LINK_LOSS.get(int(store["NAV_DLL_ACT"]), Action.NOTHING),
        # Without a position none of Return's legs can be flown: what is left of its chain is to land.
        estimator_loss=Action.RETURN,
        estimator_accuracy_m=accuracy_m if accuracy_m >= 0.0 else inf,
        estimator_ratio=inf,
        estimator_in_manual=False,
        failsafe_hold_s=store["COM_FAIL_ACT_T"],
        battery_low=Action.NOTHING,
        battery_critical=critical,
        battery_emergency=emergency,
        battery_thresholds=BatteryThresholds(
            capacity_mah=store["BAT1_CAPACITY"],
            low_v=0.0,
            critical_v=0.0,
            voltage_time_s=0.0,
            low_share=store["BAT_LOW_THR"],
            critical_share=store["BAT_CRIT_THR"],
            emergency_share=store["BAT_EMERGEN_THR"],
        ),
        battery_checked=True,
        lift_off_s=store["COM_SPOOLUP_TIME"] + store["MPC_TKO_RAMP_T"],
        disarm_landed_s=_never_unless_positive(store["COM_DISARM_LAND"]),
        disarm_unflown_s=_never_unless_positive(store["COM_DISARM_PRFLT"]),
        tilt_rad=radians(store["MPC_TILTMAX_AIR"]),
        yaw_rate_rad_s=radians(store["MPC_YAWRAUTO_MAX"]),
        cruise_m_s=store["MPC_XY_CRUISE"],
        setpoint_speed_m_s=store["MPC_XY_VEL_MAX"],
        setpoint_acceleration_m_s2=store["MPC_ACC_HOR_MAX"],
        reached_m=1.0,
        climb_m_s=store["MPC_Z_V_AUTO_UP"],
        descent_m_s=store["MPC_Z_V_AUTO_DN"],
        acceleration_m_s2=store["MPC_ACC_HOR"],
        braking_m_s2=_PX4_BRAKING * store["MPC_ACC_HOR"],
        reaction_s=_PX4_REACTION_S,
        arrival_per_s=store["MPC_XY_TRAJ_P"],
        vertical_acceleration_m_s2=store["MPC_ACC_UP_MAX"],
        takeoff_m_s=store["MPC_TKO_SPEED"],
        takeoff_height_m=store["MIS_TAKEOFF_ALT"],
        landing_heights_m=(store["MPC_LAND_ALT3"], store["MPC_LAND_ALT2"], store["MPC_LAND_ALT1"]),
        landing_m_s=(store["MPC_LAND_CRWL"], store["MPC_LAND_SPEED"], store["MPC_Z_V_AUTO_DN"]),
        return_height_m=store["RTL_RETURN_ALT"],
        return_speed_m_s=store["MPC_XY_CRUISE"],
        return_wait_s=wait_s if wait_s >= 0.0 else inf,
        return_descent_height_m=store["RTL_DESCEND_ALT"],
        return_cone_slope=inf,
        return_climb_min_m=0.0,
        return_min_distance_m=store["RTL_MIN_DIST"],
        path_accuracy_m=0.0,
        path_places=0,
        hand=hand_settings(store),
        fence=px4_fence(store),
        rally=px4_rally(store),
        wind=px4_wind(store),
        accept_m=store["NAV_ACC_RAD"],
        accept_height_m=store["NAV_MC_ALT_RAD"],
        yaw_behaviour=_PX4_YAW[int(store["MPC_YAW_MODE"])],
        circle_radius_m=1.0,
        circle_rate_rad_s=inf,
        mission_restarts=False,
        mission_arms=True,
        mission_lifts=True,
        mission_farthest_m=_never_unless_positive(store["MIS_DIST_1WP"]),
        mission_needs_takeoff=int(store["MIS_TKO_LAND_REQ"]) in (1, 3),
        mission_needs_landing=int(store["MIS_TKO_LAND_REQ"]) in (2, 3),
        mission_needs_both_or_none=int(store["MIS_TKO_LAND_REQ"]) == _BOTH_OR_NONE,
    )


def flight_settings(store: ParameterStore) -> FlightSettings:
    """Return the settings that the parameters of `store` amount to now."""
    return _from_px4(store) if store.flavour is Flavour.PX4 else _from_ardupilot(store)
