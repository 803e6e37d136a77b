"""Identity and health: heartbeat, sensors that work, estimator, battery, landed state, version.

Message definitions: https://mavlink.io/en/messages/common.html and ardupilotmega.html.
"""

from typing import Final

from vehicle_sim.autopilot import Failsafe
from vehicle_sim.battery import BatteryLevel
from vehicle_sim.parameters import Action, Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host
from vehicle_sim.protocol.units import clamp, clamp16

_ALWAYS_WELL: Final = (
    mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG
    | mavlink.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE
    | mavlink.MAV_SYS_STATUS_SENSOR_ANGULAR_RATE_CONTROL
    | mavlink.MAV_SYS_STATUS_SENSOR_ATTITUDE_STABILIZATION
    | mavlink.MAV_SYS_STATUS_SENSOR_YAW_POSITION
    | mavlink.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
)
_GPS: Final = mavlink.MAV_SYS_STATUS_SENSOR_GPS
_HEIGHT: Final = mavlink.MAV_SYS_STATUS_SENSOR_Z_ALTITUDE_CONTROL
_PLACE: Final = mavlink.MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
_AHRS: Final = mavlink.MAV_SYS_STATUS_AHRS
_BATTERY: Final = mavlink.MAV_SYS_STATUS_SENSOR_BATTERY
_FENCE: Final = mavlink.MAV_SYS_STATUS_GEOFENCE
_RADIO: Final = mavlink.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
_PREARM: Final = mavlink.MAV_SYS_STATUS_PREARM_CHECK
_PRESENT: Final = _ALWAYS_WELL | _GPS | _HEIGHT | _PLACE | _AHRS | _BATTERY | _PREARM

_FIX_3D: Final = mavlink.GPS_FIX_TYPE_3D_FIX
_EKF_UNINITIALISED: Final = mavlink.EKF_UNINITIALIZED
_EKF_GPS_GLITCH: Final = 32768  # EKF_STATUS_FLAGS, `EKF_GPS_GLITCHING` in newer dialects
_ESTIMATOR_GPS_GLITCH: Final = mavlink.ESTIMATOR_GPS_GLITCH
_NO_CELL: Final = 65535
_NO_TEMPERATURE: Final = 32767
_ARMED: Final = mavlink.MAV_MODE_FLAG_SAFETY_ARMED


def heartbeat(host: Host) -> Message | None:
    """HEARTBEAT: what it is, its mode, whether it is armed, whether all is well."""
    autopilot, table = host.vehicle.autopilot, host.table
    armed = autopilot.armed
    if autopilot.terminated:
        state = mavlink.MAV_STATE_FLIGHT_TERMINATION
    elif autopilot.failsafe is Failsafe.BATTERY_EMERGENCY:
        state = mavlink.MAV_STATE_EMERGENCY
    elif autopilot.in_failsafe:
        state = mavlink.MAV_STATE_CRITICAL
    else:
        state = mavlink.MAV_STATE_ACTIVE if armed else mavlink.MAV_STATE_STANDBY
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_QUADROTOR,
        table.autopilot,
        table.base_modes[autopilot.mode] | (_ARMED if armed else 0),
        table.custom_modes[autopilot.mode],
        state,
        3,
    )


def sys_status(host: Host) -> Message | None:
    """SYS_STATUS: which sensors are there and well, whether it could be armed, battery."""
    vehicle = host.vehicle
    status, autopilot, battery = vehicle.estimate.status, vehicle.autopilot, vehicle.battery
    gps, well = vehicle.readings.gps, _ALWAYS_WELL
    well |= _GPS if gps is not None and gps.fix_type >= _FIX_3D else 0
    well |= _HEIGHT if status.height_ok else 0
    well |= _PLACE if status.position_ok else 0
    well |= _AHRS if status.attitude_ok else 0
    well |= _BATTERY if battery.level == BatteryLevel.OK else 0
    well |= _PREARM if autopilot.armed or not (autopilot.terminated or autopilot.prearm_faults) else 0
    there, on = _PRESENT, _PRESENT
    if autopilot.pilot.heard_s is not None:
        there, on = there | _RADIO, on | _RADIO
        well |= 0 if autopilot.pilot.is_lost(vehicle.time_s) else _RADIO
    # PX4's SYS_STATUS says nothing of its fence.
    if host.table.flavour is Flavour.ARDUPILOT and (fence := autopilot.guard.fence).is_there:
        there |= _FENCE
        on |= _FENCE if fence.enabled and autopilot.settings.fence.action is not Action.NOTHING else 0
        well |= 0 if fence.breached else _FENCE
    return mavlink.MAVLink_sys_status_message(
        there,
        on,
        well,
        0,
        clamp(battery.voltage_v * 1000, 0, _NO_CELL - 1),
        clamp16(battery.current_a * 100),
        clamp(battery.remaining * 100, 0, 100),
        *(0,) * 6,
    )


def battery_status(host: Host) -> Message | None:
    """BATTERY_STATUS: voltage, current and charge of the one battery."""
    battery = host.vehicle.battery
    volts = clamp(battery.voltage_v * 1000, 0, _NO_CELL - 1)
    return mavlink.MAVLink_battery_status_message(
        0,
        mavlink.MAV_BATTERY_FUNCTION_ALL,
        mavlink.MAV_BATTERY_TYPE_LIPO,
        _NO_TEMPERATURE,
        (volts, *(_NO_CELL,) * 9),
        clamp16(battery.current_a * 100),
        round(battery.consumed_mah),
        -1,
        clamp(battery.remaining * 100, 0, 100),
        0,
        mavlink.MAV_BATTERY_CHARGE_STATE_OK + int(battery.level),
    )


def power_status(_host: Host) -> Message | None:
    """POWER_STATUS: the supply of the flight controller itself, which never fails here."""
    return mavlink.MAVLink_power_status_message(5000, 0, mavlink.MAV_POWER_STATUS_BRICK_VALID)


def meminfo(_host: Host) -> Message | None:
    """MEMINFO (ArduPilot): how much memory is left, which is always plenty."""
    return mavlink.MAVLink_meminfo_message(0, _NO_CELL, 1 << 19)


def extended_sys_state(host: Host) -> Message | None:
    """EXTENDED_SYS_STATE: on the ground, in the air, or between."""
    landed = host.vehicle.autopilot.landed_state
    return mavlink.MAVLink_extended_sys_state_message(mavlink.MAV_VTOL_STATE_UNDEFINED, int(landed))


def ekf_status_report(host: Host) -> Message | None:
    """EKF_STATUS_REPORT (ArduPilot): what the estimator vouches for, and how well measurements agree with it."""
    status = host.vehicle.estimate.status
    flags = int(status.flags)
    flags |= 0 if status.initialised else _EKF_UNINITIALISED
    flags |= _EKF_GPS_GLITCH if status.gps_glitch else 0
    return mavlink.MAVLink_ekf_status_report_message(
        flags,
        status.velocity_ratio,
        status.position_horizontal_ratio,
        status.position_vertical_ratio,
        status.compass_ratio,
        0.0,
    )


def estimator_status(host: Host) -> Message | None:
    """ESTIMATOR_STATUS (PX4): the same, with accuracies in metres."""
    status = host.vehicle.estimate.status
    return mavlink.MAVLink_estimator_status_message(
        host.now_us,
        int(status.flags) | (_ESTIMATOR_GPS_GLITCH if status.gps_glitch else 0),
        status.velocity_ratio,
        status.position_horizontal_ratio,
        status.position_vertical_ratio,
        status.compass_ratio,
        0.0,
        0.0,
        status.horizontal_accuracy_m,
        status.vertical_accuracy_m,
    )


def flight_information(host: Host) -> Message | None:
    """FLIGHT_INFORMATION: when it was armed and took off, in microseconds since boot, and how many flights are over.

    The fields' names speak of a date and of an identifier; that is history.
    """
    autopilot = host.vehicle.autopilot
    armed_us, airborne_us = (round((at_s or 0.0) * 1e6) for at_s in (autopilot.armed_at_s, autopilot.taken_off_at_s))
    return mavlink.MAVLink_flight_information_message(host.now_us // 1000, armed_us, airborne_us, autopilot.flights)


def autopilot_version(host: Host) -> Message | None:
    """AUTOPILOT_VERSION: capabilities and the version of the autopilot that it answers like."""
    table, eight_zeros = host.table, (0,) * 8
    return mavlink.MAVLink_autopilot_version_message(
        int(table.capabilities),
        table.software_version,
        table.software_version if table.flavour is Flavour.PX4 else 0,
        0,
        0,
        tuple(table.git_hash),
        eight_zeros,
        eight_zeros,
        0,
        0,
        host.system_id,
    )
