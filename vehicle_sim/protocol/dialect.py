"""The MAVLink dialect that the vehicle speaks: the one place that names a pymavlink module.

`ardupilotmega` contains all of `common`, so it serves both flavours. pymavlink ships no type information; `Message` is
an alias that says what is meant. The number of a message is `get_msgId()`: its `id` is a field of some messages.
"""

from typing import TypeAlias

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from vehicle_sim.protocol.data_files import data_file

__all__ = ["AUTOPILOT_COMPONENT", "LAST_V1_ID", "MAGIC_V1", "MAGIC_V2", "V1_PAYLOAD_LENGTHS", "Message", "mavlink"]

Message: TypeAlias = mavlink.MAVLink_message

AUTOPILOT_COMPONENT = mavlink.MAV_COMP_ID_AUTOPILOT1
MAGIC_V1 = 0xFE
MAGIC_V2 = 0xFD
LAST_V1_ID = 255

# Payload lengths without the extension fields that MAVLink 2 added, of all messages that have any and whose number fits
# MAVLink 1, whose frames end there (message definitions `common.xml` and `ardupilotmega.xml`, before `<extensions/>`).
V1_PAYLOAD_LENGTHS = {
    getattr(mavlink, f"MAVLINK_MSG_ID_{name}"): length for name, length in data_file("v1_lengths").items()
}
