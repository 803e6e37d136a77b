"""What tells ArduCopter and PX4 apart on the wire: one table for each.

Observed on the wire of ArduCopter 4.7.0-dev and PX4 v1.16.1 in their own simulators, and read in their sources:
ArduPilot `GCS_Common.cpp`, `GCS_MAVLink_Copter.cpp`, `mode.h`; PX4 `mavlink_main.cpp`, `px4_custom_mode.h`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Final

from vehicle_sim.autopilot import MODES, Mode, Outcome
from vehicle_sim.autopilot.modes import is_by_hand
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.data_files import data_file
from vehicle_sim.protocol.dialect import mavlink
from vehicle_sim.protocol.late_messages import ComponentMetadata, CurrentMode

_CUSTOM = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
_STABILIZED = mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
_GUIDED = mavlink.MAV_MODE_FLAG_GUIDED_ENABLED
_AUTO = mavlink.MAV_MODE_FLAG_AUTO_ENABLED
_STICKS = mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED


class Rates(Enum):
    """What a link is for, hence what is streamed on it unasked."""

    SILENT = auto()
    GROUND_STATION = auto()
    ONBOARD = auto()


@dataclass(frozen=True, slots=True, kw_only=True)
class FlavourTable:
    """Identity, numbers and habits of one autopilot.

    Attributes:
        autopilot: MAV_AUTOPILOT of the heartbeat.
        capabilities: What AUTOPILOT_VERSION says that it understands.
        software_version: major << 24 | minor << 16 | patch << 8 | release type.
        git_hash: What it was built from, as AUTOPILOT_VERSION holds it: eight digits, or eight bytes from the last on.
        custom_modes: The number that stands for each mode.
        base_modes: Flags of the heartbeat's base_mode in each mode, without the armed bit.
        default_rates_hz: What is streamed unasked, by the link's purpose: message id to messages per second.
        stream_parameters: The parameter that holds the unasked rate of each group, by the link's purpose.
        stream_groups: Messages of each MAV_DATA_STREAM; empty where REQUEST_DATA_STREAM names a message id instead.
        absent_messages: Messages of the vehicle that this autopilot does not have.
        told_on_change: Messages that no stream repeats, whatever rate was accepted: they come on change and on request.
        no_stream: Result of SET_MESSAGE_INTERVAL for a message that it does not have.
        no_message: Result of REQUEST_MESSAGE for such a message.
        no_mode: Result of a request for a mode that it does not have.
        bytewise_parameters: Whether integer parameters travel as their bytes instead of as a float of equal value.
        names_parameters_on_set: Whether an echo carries the parameter's index, or 65535.
        plan_retry_us: After this long it asks again for a plan item.
        plan_timeout_us: After this long without an item it gives an upload up.
        plan_request_id: The message with which it asks for items.
        home_is_item_0: Whether item 0 of a mission is the home position.
        system_id_parameter: The parameter that holds the system id.
        no_reboot: Result of a request to restart while armed.
        answers_ping: Whether PING is answered.
        tells_pictures: Whether each picture is told on every link, and not on those alone that stream such messages.
        takeoff_is_amsl: Whether NAV_TAKEOFF's height is above mean sea level instead of above home.
    """

    flavour: Flavour
    autopilot: int
    capabilities: int
    software_version: int
    git_hash: bytes
    custom_modes: Mapping[Mode, int]
    base_modes: Mapping[Mode, int]
    default_rates_hz: Mapping[Rates, Mapping[int, float]]
    stream_parameters: Mapping[Rates, Mapping[int, str]]
    stream_groups: Mapping[int, tuple[int, ...]]
    absent_messages: frozenset[int]
    told_on_change: frozenset[int]
    no_stream: Outcome
    no_message: Outcome
    no_mode: Outcome
    bytewise_parameters: bool
    names_parameters_on_set: bool
    plan_retry_us: int
    plan_timeout_us: int
    plan_request_id: int
    home_is_item_0: bool
    system_id_parameter: str
    no_reboot: Outcome
    answers_ping: bool
    tells_pictures: bool
    takeoff_is_amsl: bool
    modes: Mapping[int, Mode] = field(init=False)

    def __post_init__(self) -> None:
        """Invert the table of modes."""
        object.__setattr__(self, "modes", {number: mode for mode, number in self.custom_modes.items()})


_NUMBERS: Final = {kind.msgname: number for number, kind in mavlink.mavlink_map.items()}


def _capabilities(flavour: Flavour) -> int:
    """Return MAV_PROTOCOL_CAPABILITY as a file has it by names; pymavlink has renamed some of them over time."""
    file = data_file("capabilities")
    return sum(file["bits"][name] for name in file[flavour.value])


def _rates(name: str) -> dict[Rates, dict[int, float]]:
    """Return the rates in Hz that a file holds for each purpose of a link, by the names of the messages."""
    return {
        Rates[purpose]: {_NUMBERS[message]: hertz for message, hertz in rates.items()}
        for purpose, rates in data_file(name).items()
    }


def _messages(*names: str) -> tuple[int, ...]:
    return tuple(getattr(mavlink, f"MAVLINK_MSG_ID_{name}") for name in names)


_ARDUPILOT: Final = FlavourTable(
    flavour=Flavour.ARDUPILOT,
    autopilot=mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
    capabilities=_capabilities(Flavour.ARDUPILOT),
    software_version=0x04070000,
    git_hash=b"90700977",
    custom_modes={Mode[name]: number for name, number in data_file("modes")["ardupilot"].items()},
    base_modes={
        mode: _CUSTOM | _STABILIZED | _STICKS | (0 if rule.manual or mode is Mode.LAND else _GUIDED)
        for mode, rule in MODES[Flavour.ARDUPILOT].items()
    },
    default_rates_hz={rates: {} for rates in Rates},
    stream_parameters={
        rates: {
            mavlink.MAV_DATA_STREAM_RAW_SENSORS: f"MAV{number}_RAW_SENS",
            mavlink.MAV_DATA_STREAM_EXTENDED_STATUS: f"MAV{number}_EXT_STAT",
            mavlink.MAV_DATA_STREAM_RC_CHANNELS: f"MAV{number}_RC_CHAN",
            mavlink.MAV_DATA_STREAM_POSITION: f"MAV{number}_POSITION",
            mavlink.MAV_DATA_STREAM_EXTRA1: f"MAV{number}_EXTRA1",
            mavlink.MAV_DATA_STREAM_EXTRA2: f"MAV{number}_EXTRA2",
            mavlink.MAV_DATA_STREAM_EXTRA3: f"MAV{number}_EXTRA3",
        }
        for rates, number in ((Rates.ONBOARD, 1), (Rates.GROUND_STATION, 2))
    },
    stream_groups={
        getattr(mavlink, f"MAV_DATA_STREAM_{group}"): tuple(_NUMBERS[name] for name in messages)
        for group, messages in data_file("ardupilot_groups").items()
    },
    absent_messages=frozenset(
        _messages("ESTIMATOR_STATUS", "ALTITUDE", "ODOMETRY", "WIND_COV", "ORBIT_EXECUTION_STATUS")
    )
    | {CurrentMode.id, ComponentMetadata.id},
    told_on_change=frozenset(),
    no_stream=Outcome.DENIED,
    no_message=Outcome.FAILED,
    no_mode=Outcome.FAILED,
    bytewise_parameters=False,
    names_parameters_on_set=False,
    plan_retry_us=1_000_000,
    plan_timeout_us=8_000_000,
    plan_request_id=mavlink.MAVLINK_MSG_ID_MISSION_REQUEST,
    home_is_item_0=True,
    system_id_parameter="MAV_SYSID",
    no_reboot=Outcome.FAILED,
    answers_ping=False,
    tells_pictures=True,
    takeoff_is_amsl=False,
)

_BY_HAND = _CUSTOM | _STABILIZED | _STICKS
_BY_ITSELF = _CUSTOM | _STABILIZED | _GUIDED | _AUTO

_PX4: Final = FlavourTable(
    flavour=Flavour.PX4,
    autopilot=mavlink.MAV_AUTOPILOT_PX4,
    capabilities=_capabilities(Flavour.PX4),
    software_version=0x011001FF,
    git_hash=bytes.fromhex("94cb201200000000")[::-1],
    custom_modes={Mode[name]: main << 16 | sub << 24 for name, (main, sub) in data_file("modes")["px4"].items()},
    base_modes={mode: _BY_HAND if is_by_hand(mode, rule) else _BY_ITSELF for mode, rule in MODES[Flavour.PX4].items()},
    default_rates_hz={Rates.SILENT: {}, **_rates("px4_rates")},
    stream_parameters={},
    stream_groups={},
    absent_messages=frozenset(_messages(*data_file("px4_absent")["messages"])),
    told_on_change=frozenset(_messages("GPS_GLOBAL_ORIGIN", "CAMERA_TRIGGER", "CAMERA_IMAGE_CAPTURED")),
    no_stream=Outcome.FAILED,
    no_message=Outcome.DENIED,
    no_mode=Outcome.TEMPORARILY_REJECTED,
    bytewise_parameters=True,
    names_parameters_on_set=True,
    plan_retry_us=250_000,
    plan_timeout_us=5_000_000,
    plan_request_id=mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT,
    home_is_item_0=False,
    system_id_parameter="MAV_SYS_ID",
    no_reboot=Outcome.DENIED,
    answers_ping=True,
    tells_pictures=False,
    takeoff_is_amsl=True,
)

TABLES: Final[Mapping[Flavour, FlavourTable]] = {Flavour.ARDUPILOT: _ARDUPILOT, Flavour.PX4: _PX4}
"""The table of each flavour."""
