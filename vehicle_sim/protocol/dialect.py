"""The MAVLink dialect that the vehicle speaks: the one place that names a pymavlink module.

`ardupilotmega` contains all of `common`, so it serves both flavours. pymavlink ships no type information; `Message` is
an alias that says what is meant. The number of a message is `get_msgId()`: its `id` is a field of some messages.
"""

from typing import TypeAlias

from pymavlink.dialects.v20 import ardupilotmega as mavlink

__all__ = [
    "AUTOPILOT_COMPONENT",
    "LAST_V1_ID",
    "MAGIC_V1",
    "MAGIC_V2",
    "V1_PAYLOAD_LENGTHS",
    "Message",
    "mavlink",
]

Message: TypeAlias = mavlink.MAVLink_message

AUTOPILOT_COMPONENT = mavlink.MAV_COMP_ID_AUTOPILOT1
MAGIC_V1 = 0xFE
MAGIC_V2 = 0xFD
LAST_V1_ID = 255

# Payload lengths without the extension fields that MAVLink 2 added, of all messages that have any and whose number fits
# MAVLink 1, whose frames end there (message definitions `common.xml` and `ardupilotmega.xml`, before `<extensions/>`).
V1_PAYLOAD_LENGTHS = {
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: 31,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 30,
    mavlink.MAVLINK_MSG_ID_SCALED_IMU: 22,
    mavlink.MAVLINK_MSG_ID_RAW_IMU: 26,
    mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE: 14,
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: 32,
    mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: 21,
    mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_PARTIAL_LIST: 6,
    mavlink.MAVLINK_MSG_ID_MISSION_WRITE_PARTIAL_LIST: 6,
    mavlink.MAVLINK_MSG_ID_MISSION_ITEM: 37,
    mavlink.MAVLINK_MSG_ID_MISSION_REQUEST: 4,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: 2,
    mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_LIST: 2,
    mavlink.MAVLINK_MSG_ID_MISSION_COUNT: 4,
    mavlink.MAVLINK_MSG_ID_MISSION_CLEAR_ALL: 2,
    mavlink.MAVLINK_MSG_ID_MISSION_ACK: 3,
    mavlink.MAVLINK_MSG_ID_SET_GPS_GLOBAL_ORIGIN: 13,
    mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: 12,
    mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT: 4,
    mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL: 11,
    mavlink.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE: 18,
    mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT: 37,
    mavlink.MAVLINK_MSG_ID_COMMAND_ACK: 3,
    mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW: 26,
    mavlink.MAVLINK_MSG_ID_GLOBAL_VISION_POSITION_ESTIMATE: 32,
    mavlink.MAVLINK_MSG_ID_VISION_POSITION_ESTIMATE: 32,
    mavlink.MAVLINK_MSG_ID_VISION_SPEED_ESTIMATE: 20,
    mavlink.MAVLINK_MSG_ID_VICON_POSITION_ESTIMATE: 32,
    mavlink.MAVLINK_MSG_ID_HIGHRES_IMU: 62,
    mavlink.MAVLINK_MSG_ID_HIL_SENSOR: 64,
    mavlink.MAVLINK_MSG_ID_SIM_STATE: 84,
    mavlink.MAVLINK_MSG_ID_TIMESYNC: 16,
    mavlink.MAVLINK_MSG_ID_HIL_GPS: 36,
    mavlink.MAVLINK_MSG_ID_SCALED_IMU2: 22,
    mavlink.MAVLINK_MSG_ID_GPS2_RAW: 35,
    mavlink.MAVLINK_MSG_ID_SCALED_IMU3: 22,
    mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: 14,
    mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE2: 14,
    mavlink.MAVLINK_MSG_ID_ATT_POS_MOCAP: 36,
    mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE3: 14,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 36,
    mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION: 60,
    mavlink.MAVLINK_MSG_ID_LANDING_TARGET: 30,
    mavlink.MAVLINK_MSG_ID_MEMINFO: 4,
    mavlink.MAVLINK_MSG_ID_MOUNT_STATUS: 14,
    mavlink.MAVLINK_MSG_ID_FENCE_STATUS: 8,
    mavlink.MAVLINK_MSG_ID_CAMERA_FEEDBACK: 45,
    mavlink.MAVLINK_MSG_ID_MAG_CAL_REPORT: 44,
    mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT: 22,
    mavlink.MAVLINK_MSG_ID_PID_TUNING: 25,
    mavlink.MAVLINK_MSG_ID_EFI_STATUS: 65,
    mavlink.MAVLINK_MSG_ID_GPS_INPUT: 63,
    mavlink.MAVLINK_MSG_ID_HOME_POSITION: 52,
    mavlink.MAVLINK_MSG_ID_SET_HOME_POSITION: 53,
    mavlink.MAVLINK_MSG_ID_STATUSTEXT: 51,
}
