"""QGroundControl's parameter manager, and what each of its setup pages looks up among the parameters.

A page opens "Parameters are missing from firmware" for each name that it does not find. Names are those of its sources:
src/AutoPilotPlugins/APM and PX4, and of the firmware plug-ins for what is flown.
"""

import re
from itertools import cycle
from struct import pack, unpack
from zlib import crc32

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.file_client import ACK, BURST, OPEN, TERMINATE, FileClient
from tests.support.ground_station import GroundStation
from tests.support.unpacked import unpacked
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4


def each(template: str, *fillings: object) -> str:
    return " ".join(template.replace("#", str(filling)) for filling in fillings)


PAGES = {
    (AP, "frame"): "FRAME_CLASS FRAME_TYPE",
    (AP, "radio"): "RCMAP_ROLL RCMAP_PITCH RCMAP_YAW RCMAP_THROTTLE "
    + each("RC#_MIN RC#_MAX RC#_TRIM RC#_REVERSED", *range(1, 17)),
    (AP, "flight modes"): "FLTMODE_CH SIMPLE SUPER_SIMPLE "
    + each("FLTMODE#", *range(1, 7))
    + each(" RC#_OPTION", *range(6, 17)),
    (AP, "sensors"): "COMPASS_DEC COMPASS_LEARN COMPASS_CAL_FIT COMPASS_EXTERNAL COMPASS_EXTERN2 COMPASS_EXTERN3 "
    + each("COMPASS_DEV_ID# COMPASS_USE# COMPASS_ORIENT# COMPASS_OFS#_X COMPASS_OFS#_Y COMPASS_OFS#_Z ", "", 2, 3)
    + each("COMPASS_PRIO#_ID BARO#_DEVID ", 1, 2, 3)
    + each("INS_ACC#_ID INS_ACC#OFFS_X INS_ACC#OFFS_Y INS_ACC#OFFS_Z ", "", 2, 3)
    + "INS_USE INS_USE2 INS_USE3 AHRS_ORIENTATION",
    (AP, "power"): "BATT_CAPACITY BATT_ARM_VOLT BATT_AMP_PERVLT BATT_AMP_OFFSET BATT_VOLT_MULT BATT_VOLT_PIN "
    "BATT_CURR_PIN BATT_MONITOR MOT_PWM_MIN MOT_PWM_MAX ESC_CALIBRATION " + each("BATT#_MONITOR ", *range(2, 10)),
    (AP, "safety"): "FS_GCS_ENABLE FS_GCS_TIMEOUT FS_THR_ENABLE FS_THR_VALUE FS_EKF_ACTION FS_EKF_THRESH FS_OPTIONS "
    "BATT_FS_LOW_ACT BATT_FS_CRT_ACT BATT_LOW_MAH BATT_CRT_MAH BATT_LOW_VOLT BATT_CRT_VOLT FENCE_ACTION FENCE_ALT_MAX "
    "FENCE_ENABLE FENCE_MARGIN FENCE_RADIUS FENCE_TYPE FENCE_TOTAL LAND_SPEED RTL_ALT RTL_LOIT_TIME RTL_ALT_FINAL "
    "ARMING_CHECK",
    (
        AP,
        "tuning",
    ): "ATC_INPUT_TC ATC_ANG_RLL_P ATC_ANG_PIT_P ATC_ANG_YAW_P PSC_ACCZ_P PSC_ACCZ_I PSC_POSXY_P PSC_POSZ_P "
    "PSC_VELXY_P PSC_VELZ_P MOT_THST_HOVER MOT_SPIN_ARM MOT_SPIN_MIN AUTOTUNE_AXES TUNE TUNE_MIN TUNE_MAX "
    + each("ATC_RAT_#_P ATC_RAT_#_I ATC_RAT_#_D ATC_RAT_#_FF ", "RLL", "PIT", "YAW"),
    (AP, "gimbal"): "MNT1_TYPE MNT1_DEFLT_MODE MNT1_OPTIONS MNT1_RC_RATE MNT1_LEAD_PTCH MNT1_LEAD_RLL "
    + each("MNT1_NEUTRAL_# MNT1_RETRACT_# ", *"XYZ")
    + each("MNT1_#_MIN MNT1_#_MAX ", "PITCH", "ROLL", "YAW"),
    (AP, "flight"): "PILOT_TKOFF_ALT WPNAV_SPEED WPNAV_SPEED_UP LOIT_SPEED FOLL_ENABLE MAV_GCS_SYSID MAV_SYSID",
    (PX4, "airframe"): "SYS_AUTOSTART SYS_AUTOCONFIG MAV_SYS_ID MAV_TYPE",
    (PX4, "sensors"): "SENS_BOARD_ROT SENS_BOARD_X_OFF SENS_BOARD_Y_OFF SENS_BOARD_Z_OFF SENS_DPRES_OFF SYS_HAS_MAG "
    "CAL_GYRO0_ID CAL_ACC0_ID SYS_HAS_GPS SYS_HAS_BARO " + each("CAL_MAG#_ID CAL_MAG#_ROT ", 0, 1, 2),
    (PX4, "radio"): "COM_RC_IN_MODE RC_CHAN_CNT "
    + each("RC_MAP_# ", "ROLL", "PITCH", "YAW", "THROTTLE", "FLAPS", "AUX1", "AUX2", "PARAM1", "PARAM2", "PARAM3")
    + each("RC#_MIN RC#_MAX RC#_TRIM RC#_REV ", *range(1, 19)),
    (PX4, "flight modes"): each("COM_FLTMODE# ", *range(1, 7))
    + each("RC_MAP_# ", "FLTMODE", "RETURN_SW", "KILL_SW", "OFFB_SW", "ARM_SW", "LOITER_SW", "GEAR_SW", "MODE_SW"),
    (PX4, "power"): "BAT1_SOURCE BAT1_N_CELLS BAT1_V_CHARGED BAT1_V_EMPTY BAT1_CAPACITY BAT1_R_INTERNAL",
    (PX4, "safety"): "GF_ACTION GF_MAX_HOR_DIST GF_MAX_VER_DIST RTL_LAND_DELAY RTL_RETURN_ALT RTL_DESCEND_ALT RTL_TYPE "
    "COM_LOW_BAT_ACT BAT_LOW_THR BAT_CRIT_THR BAT_EMERGEN_THR NAV_RCL_ACT COM_RC_LOSS_T NAV_DLL_ACT COM_DL_LOSS_T "
    "COM_DISARM_LAND MPC_LAND_SPEED CP_DIST SYS_HITL",
    (PX4, "tuning"): "MC_AIRMODE THR_MDL_FAC MPC_THR_HOVER MPC_XY_P MPC_Z_P MPC_XY_VEL_P_ACC MPC_XY_VEL_I_ACC "
    "MPC_XY_VEL_D_ACC MPC_Z_VEL_P_ACC MPC_Z_VEL_I_ACC MPC_Z_VEL_D_ACC MPC_ACC_HOR MPC_JERK_AUTO MPC_JERK_MAX "
    "IMU_GYRO_CUTOFF IMU_DGYRO_CUTOFF "
    + each("MC_#RATE_P MC_#RATE_I MC_#RATE_D MC_#RATE_K MC_#_P ", "ROLL", "PITCH", "YAW"),
    (PX4, "flight behaviour"): "SYS_VEHICLE_RESP MPC_XY_VEL_ALL MPC_Z_VEL_ALL NAV_ACC_RAD",
    (PX4, "actuators"): "CA_AIRFRAME CA_ROTOR_COUNT "
    + each("CA_ROTOR#_PX CA_ROTOR#_PY CA_ROTOR#_KM ", *range(4))
    + each("PWM_MAIN_FUNC# ", *range(1, 9)),
    (PX4, "camera"): "TRIG_MODE TRIG_INTERFACE TRIG_INTERVAL TRIG_ACT_TIME TRIG_DISTANCE TRIG_POLARITY",
    (PX4, "flight"): "MIS_TAKEOFF_ALT MPC_XY_VEL_MAX MPC_XY_CRUISE NAV_LOITER_RAD COM_FLIGHT_UUID LND_FLIGHT_T_HI",
}
"""The names that each page looks up, by the autopilot and the page."""

SET_UP = {
    AP: "FRAME_CLASS BATT_MONITOR COMPASS_DEV_ID COMPASS_OFS_X COMPASS_OFS_Y COMPASS_OFS_Z INS_ACCOFFS_X INS_ACCOFFS_Y "
    "INS_ACCOFFS_Z RCMAP_ROLL RCMAP_PITCH RCMAP_YAW RCMAP_THROTTLE",
    PX4: "SYS_AUTOSTART CAL_GYRO0_ID CAL_ACC0_ID CAL_MAG0_ID BAT1_N_CELLS BAT1_V_CHARGED BAT1_V_EMPTY",
}
"""Parameters by which a page sees that its part of the vehicle is set up: none of them is zero."""


def value_of(flavour: Flavour, message: Message) -> float:
    if flavour is PX4 and message.param_type != mavlink.MAV_PARAM_TYPE_REAL32:
        return float(unpack("<i", pack("<f", message.param_value))[0])
    return float(message.param_value)


@pytest.fixture(scope="module")
def loaded() -> dict[Flavour, dict[str, Message]]:
    """All parameters of each flavour, by a line that loses every third value, and now and then three in a row."""
    lost = [place % 3 == 0 or place % 50 in (7, 8) for place in range(150)]
    return {flavour: GroundStation(flavour).parameters(cycle(lost)) for flavour in Flavour}


@pytest.mark.parametrize("flavour", Flavour)
def test_a_line_that_loses_values_leaves_none_out(flavour: Flavour, loaded: dict[Flavour, dict[str, Message]]) -> None:
    values = loaded[flavour]
    assert {message.param_count for message in values.values()} == {len(values)}
    assert sorted(message.param_index for message in values.values()) == list(range(len(values)))


@pytest.mark.parametrize(("flavour", "page"), PAGES)
def test_each_page_finds_what_it_looks_up(
    flavour: Flavour, page: str, loaded: dict[Flavour, dict[str, Message]]
) -> None:
    assert [name for name in PAGES[flavour, page].split() if name not in loaded[flavour]] == []


@pytest.mark.parametrize("flavour", Flavour)
def test_no_page_asks_for_a_setup(flavour: Flavour, loaded: dict[Flavour, dict[str, Message]]) -> None:
    values = {name: value_of(flavour, message) for name, message in loaded[flavour].items()}
    assert [name for name in SET_UP[flavour].split() if not values[name]] == []
    sticks = [int(values[f"RCMAP_{stick}"]) for stick in ("ROLL", "PITCH", "YAW", "THROTTLE")] if flavour is AP else ()
    for channel in sticks:
        least, middle, most = (values[f"RC{channel}_{end}"] for end in ("MIN", "TRIM", "MAX"))
        assert least < middle < most
        assert (least, most) != (1100.0, 1900.0)  # so a channel is known that was never calibrated
    # Without a radio PX4's page is content with a joystick.
    assert flavour is AP or values["COM_RC_IN_MODE"] == 1.0


def test_the_file_of_all_parameters_says_the_same(loaded: dict[Flavour, dict[str, Message]]) -> None:
    """ArduPilot's are loaded by MAVLink FTP, in bursts, where it claims to have that."""
    station = GroundStation(AP)
    version = station.requests(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    assert version is not None
    assert version.capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_FTP
    client = FileClient(station)
    opened = client.ask(OPEN, b"@PARAM/param.pck?withdefaults=1")
    assert opened.opcode == ACK
    content = bytearray()
    while True:
        station.forget()
        station.send(client.message(BURST, session=opened.session, offset=len(content), size=239))
        station.wait_until(lambda: any(answer.ends_burst or answer.error for answer in client.answers), within_s=5.0)
        blocks = [answer for answer in client.answers if answer.opcode == ACK]
        for block in blocks:
            assert block.offset == len(content)
            content += block.data
        if client.answers[-1].error:
            break
    assert client.ask(TERMINATE, session=opened.session).opcode == ACK
    _magic, total, parameters = unpacked(bytes(content))
    assert total == len(parameters) == len(loaded[AP])
    assert {one.name: one.value for one in parameters} == {
        name: message.param_value for name, message in loaded[AP].items()
    }
    assert all(one.value == one.default for one in parameters)


def test_a_ground_station_that_knows_the_values_already_is_spared_them(
    loaded: dict[Flavour, dict[str, Message]],
) -> None:
    """As PX4 the checksum comes first: where it is that of the values that are kept, the list is called off.

    It is made without those that the autopilot changes by itself, which ground stations know as volatile.
    """
    checksum, volatile = 0, re.compile("CAL_.*(OFF|SCALE|DIAG|COMP)|EKF2_MAG_DECL|LND_FLIGHT_T_..|COM_FLIGHT_UUID")
    for name, message in sorted(loaded[PX4].items()):
        if volatile.fullmatch(name):
            continue
        for part in (name.encode(), pack("<f", message.param_value)):
            checksum = crc32(part, checksum ^ 0xFFFFFFFF) ^ 0xFFFFFFFF
    station = GroundStation(PX4)
    station.send(mavlink.MAVLink_param_request_list_message(1, mavlink.MAV_COMP_ID_ALL))
    told = station.of("PARAM_VALUE")[0]
    assert told.param_id == "_HASH_CHECK"
    # On the way through a float the quiet bit of a NaN may be set.
    assert unpack("<I", pack("<f", told.param_value))[0] in (checksum, checksum | 0x400000)
    kind = mavlink.MAV_PARAM_TYPE_UINT32
    station.send(mavlink.MAVLink_param_set_message(1, 1, b"_HASH_CHECK", told.param_value, kind))
    station.forget()
    station.run(1.0)
    assert station.of("PARAM_VALUE") == []


@pytest.mark.parametrize("flavour", Flavour)
def test_all_values_that_a_ground_station_keeps_can_be_set_again(
    flavour: Flavour, loaded: dict[Flavour, dict[str, Message]]
) -> None:
    """So a file of parameters is loaded: each is set and told, and none is refused."""
    station = GroundStation(flavour)
    for name, kept in loaded[flavour].items():
        station.forget()
        station.send(mavlink.MAVLink_param_set_message(1, 1, name.encode(), kept.param_value, kept.param_type))
        told = station.last("PARAM_VALUE")
        assert (told.param_id, pack("<f", told.param_value)) == (name, pack("<f", kept.param_value))
        assert station.texts() == []
