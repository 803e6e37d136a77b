"""The telemetry that the vehicle can send: a builder for each message."""

from collections.abc import Callable, Mapping
from typing import Final

from vehicle_sim.protocol import guidance, health, motion, sensing
from vehicle_sim.protocol.component_metadata import component_metadata
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host
from vehicle_sim.protocol.late_messages import ComponentMetadata

Builder = Callable[[Host], Message | None]

BUILDERS: Final[Mapping[int, Builder]] = {
    mavlink.MAVLINK_MSG_ID_HEARTBEAT: health.heartbeat,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: health.sys_status,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: sensing.system_time,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: sensing.gps_raw_int,
    mavlink.MAVLINK_MSG_ID_SCALED_IMU: sensing.scaled_imu,
    mavlink.MAVLINK_MSG_ID_RAW_IMU: sensing.raw_imu,
    mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE: sensing.scaled_pressure,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: motion.attitude,
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: motion.attitude_quaternion,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: motion.local_position_ned,
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: motion.global_position_int,
    mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: sensing.servo_output_raw,
    mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: motion.gps_global_origin,
    mavlink.MAVLINK_MSG_ID_RC_CHANNELS: sensing.rc_channels,
    mavlink.MAVLINK_MSG_ID_RC_CHANNELS_RAW: sensing.rc_channels_raw,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: motion.vfr_hud,
    mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: motion.position_target_local_ned,
    mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: motion.position_target_global_int,
    mavlink.MAVLINK_MSG_ID_HIGHRES_IMU: sensing.highres_imu,
    mavlink.MAVLINK_MSG_ID_POWER_STATUS: health.power_status,
    mavlink.MAVLINK_MSG_ID_MEMINFO: health.meminfo,
    mavlink.MAVLINK_MSG_ID_ALTITUDE: motion.altitude,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: health.battery_status,
    mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION: health.autopilot_version,
    mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT: health.ekf_status_report,
    mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS: health.estimator_status,
    mavlink.MAVLINK_MSG_ID_VIBRATION: sensing.vibration,
    mavlink.MAVLINK_MSG_ID_HOME_POSITION: motion.home_position,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: health.extended_sys_state,
    mavlink.MAVLINK_MSG_ID_FLIGHT_INFORMATION: health.flight_information,
    mavlink.MAVLINK_MSG_ID_ODOMETRY: motion.odometry,
    mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET: guidance.attitude_target,
    mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: guidance.nav_controller_output,
    mavlink.MAVLINK_MSG_ID_AHRS: guidance.ahrs,
    mavlink.MAVLINK_MSG_ID_WIND: guidance.wind,
    mavlink.MAVLINK_MSG_ID_SIMSTATE: guidance.simstate,
    mavlink.MAVLINK_MSG_ID_WIND_COV: guidance.wind_cov,
    mavlink.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS: guidance.orbit_execution_status,
    ComponentMetadata.id: component_metadata,
}
"""What each message is made with; services add those that carry their own state."""

V1_ALONE: Final = frozenset({mavlink.MAVLINK_MSG_ID_RC_CHANNELS_RAW})
"""What is streamed on links of MAVLink 1 alone."""
