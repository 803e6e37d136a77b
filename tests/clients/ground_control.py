"""QGroundControl's sequences of requests, with its time-outs and tries, on a vehicle in lock-step.

Written from what its sources wait for: `InitialConnectStateMachine`, `RequestMetaDataTypeStateMachine`,
`StandardModes`, `ParameterManager`, `PlanManager`, `FTPManager`, `EventHandler`. Whatever gets no answer in time is
noted in `missing`.
"""

from collections.abc import Callable, Sequence
from json import loads
from lzma import decompress
from struct import pack, unpack, unpack_from
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.protocol.late_messages import RequestEvent

COMMAND_S, FIRST_PARAMETER_S, PLAN_S, ITEM_S, FILE_S = 3.0, 5.0, 1.5, 0.25, 1.0
TRIES = 5
ACK, NAK = 128, 129
TERMINATE, RESET, OPEN, READ, BURST = 1, 2, 4, 5, 15
AVAILABLE_MODES, COMPONENT_METADATA = 435, 397


class GroundControl(Station):
    """A ground station that goes through its sequences.

    Attributes:
        missing: What it asked for and got no answer to, in time.
    """

    def __init__(self, flavour: Flavour) -> None:
        super().__init__(endpoint_of(flavour), rates=Rates.GROUND_STATION)
        self.missing: list[str] = []
        self._sequence = 0

    def ask(
        self, what: str, message: Message, answers: Callable[[Message], bool], within_s: float, tries: int = TRIES
    ) -> Message | None:
        """Send a request, again where it is not answered, and return the first answer."""
        for _ in range(tries):
            self.forget()
            self.send(message)
            waited = 0.0
            while waited <= within_s:
                found = next((heard for heard in self.heard if answers(heard)), None)
                if found is not None:
                    return found
                self.run(0.01)
                waited += 0.01
        self.missing.append(what)
        return None

    def order(self, what: str, command: int, *params: float) -> int:
        """Send a command and return its result, -1 where there is none."""
        seven = (*params, *(0.0,) * (7 - len(params)))
        ack = self.ask(
            what,
            mavlink.MAVLink_command_long_message(1, 1, command, 0, *seven),
            lambda heard: heard.get_type() == "COMMAND_ACK" and heard.command == command,
            COMMAND_S,
        )
        return -1 if ack is None else int(ack.result)

    def wants(self, what: str, message_id: int, index: int = 0) -> Message | None:
        """Ask for a message: refused is an answer, accepted without it is none."""
        if self.order(what, mavlink.MAV_CMD_REQUEST_MESSAGE, message_id, index) != mavlink.MAV_RESULT_ACCEPTED:
            return None
        found = next((heard for heard in self.heard if heard.get_msgId() == message_id), None)
        if found is None:
            self.missing.append(f"{what} after its acknowledgement")
        return found

    # The states of the initial connection.

    def connect(self) -> None:
        """Go through all of them, in their order."""
        self.send(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3))
        self.wants("AUTOPILOT_VERSION", mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
        self.modes()
        self.component_information()
        self.parameters()
        for kind in range(3):
            self.download(kind)

    def modes(self) -> list[int]:
        """Fetch the modes one after another, and return their numbers."""
        first = self.wants("AVAILABLE_MODES", AVAILABLE_MODES, 1)
        count = 0 if first is None else int(first.number_modes)
        pages = [self.wants(f"AVAILABLE_MODES {place}", AVAILABLE_MODES, place) for place in range(1, count + 1)]
        return [int(page.custom_mode) for page in pages if page is not None]

    def component_information(self) -> dict[int, Any]:
        """Fetch the general file and those that it names, and return them by their types."""
        told = self.wants("COMPONENT_METADATA", COMPONENT_METADATA)
        if told is None:
            self.wants("COMPONENT_INFORMATION", 395)
            return {}
        general = self.json(told.uri)
        return {entry["type"]: self.json(entry["uri"]) for entry in general.get("metadataTypes", ())}

    def json(self, uri: str) -> Any:  # noqa: ANN401 - whatever is in the file
        """Fetch a packed file and unpack it."""
        data = self.file(uri.removeprefix("mftp://"))
        return loads(decompress(data)) if data else {}

    def parameters(self) -> int:
        """Fetch all parameters, ask for those that did not come, and return how many there are."""
        request = mavlink.MAVLink_param_request_list_message(1, mavlink.MAV_COMP_ID_ALL)
        first = self.ask("PARAM_REQUEST_LIST", request, is_listed, FIRST_PARAMETER_S)
        count = 0 if first is None else int(first.param_count)
        seen: set[int] = set()
        for _ in range(100):
            seen |= {heard.param_index for heard in self.heard if is_listed(heard)}
            self.forget()
            if len(seen) >= count:
                break
            self.run(0.2)
        for index in sorted(set(range(count)) - seen):
            read = mavlink.MAVLink_param_request_read_message(1, 1, b"", index)
            self.ask(f"parameter {index}", read, is_value(index), FILE_S)
        return count

    # Plans.

    def download(self, kind: int) -> list[Message]:
        """Fetch a plan."""
        request = mavlink.MAVLink_mission_request_list_message(1, 1, kind)
        count = self.ask(f"plan {kind}", request, of_plan("MISSION_COUNT", kind), PLAN_S)
        items = []
        for seq in range(0 if count is None else count.count):
            wanted = mavlink.MAVLink_mission_request_int_message(1, 1, seq, kind)
            items.append(
                self.ask(
                    f"item {seq} of plan {kind}",
                    wanted,
                    of_plan("MISSION_ITEM_INT", kind, seq),
                    ITEM_S,
                )
            )
        self.send(mavlink.MAVLink_mission_ack_message(1, 1, mavlink.MAV_MISSION_ACCEPTED, kind))
        return [item for item in items if item is not None]

    def upload(self, kind: int, items: Sequence[Message], begin: Message | None = None, first: int = 0) -> int:
        """Write a plan, or a part of one from item `first` on, and return the result; -1 where there is none."""
        message = begin or mavlink.MAVLink_mission_count_message(1, 1, len(items), kind)
        for seq in range(first, first + len(items)):
            asked = self.ask(
                f"request of item {seq} of plan {kind}",
                message,
                of_plan("MISSION_REQUEST", kind, seq),
                PLAN_S,
            )
            if asked is None:
                return -1
            message = items[seq - first]
        ack = self.ask(f"end of plan {kind}", message, of_plan("MISSION_ACK", kind), PLAN_S)
        return -1 if ack is None else int(ack.type)

    # Files.

    def file(self, path: str) -> bytes:
        """Fetch a file in bursts, and what they left out piece by piece."""
        opened = self._file_request(OPEN, path.encode())
        if opened is None or opened[3] != ACK:
            self.missing.append(f"file {path}")
            return b""
        session, (size,) = opened[2], unpack_from("<I", opened, 12)
        self.forget()
        self.send(self._file_message(BURST, session=session, size=239))
        parts: dict[int, bytes] = {}
        for _ in range(200):
            self.run(0.05)
            payloads = [bytes(heard.payload) for heard in self.of("FILE_TRANSFER_PROTOCOL")]
            self.forget()
            # Every second message is lost, so that holes have to be filled.
            parts |= {unpack_from("<I", one, 8)[0]: one[12 : 12 + one[4]] for one in payloads[::2] if one[3] == ACK}
            if any(one[3] == NAK or one[6] for one in payloads):
                break
        data = b""
        while len(data) < size:
            part = parts.get(len(data))
            if part is None:
                answer = self._file_request(READ, session=session, offset=len(data), size=239)
                part = b"" if answer is None else answer[12 : 12 + answer[4]]
            if not part:
                self.missing.append(f"bytes from {len(data)} of {path}")
                break
            data += part
        self._file_request(TERMINATE, session=session)
        self._file_request(RESET)
        return data

    def _file_message(
        self, opcode: int, data: bytes = b"", *, session: int = 0, offset: int = 0, size: int = 0
    ) -> Message:
        self._sequence = (self._sequence + 1) & 0xFFFF
        header = pack("<HBBBBBxI", self._sequence, session, opcode, size or len(data), 0, 0, offset)
        return mavlink.MAVLink_file_transfer_protocol_message(0, 1, 1, (header + data).ljust(251, b"\0"))

    def _file_request(
        self, opcode: int, data: bytes = b"", *, session: int = 0, offset: int = 0, size: int = 0
    ) -> bytes | None:
        message = self._file_message(opcode, data, session=session, offset=offset, size=size)
        wanted = (self._sequence + 1) & 0xFFFF

        def answers(heard: Message) -> bool:
            is_file = heard.get_type() == "FILE_TRANSFER_PROTOCOL"
            return bool(is_file and unpack("<H", bytes(heard.payload[:2]))[0] == wanted)

        answer = self.ask(f"file request {opcode}", message, answers, FILE_S)
        return None if answer is None else bytes(answer.payload)

    # Events.

    def events(self, wanted: int) -> list[Message]:
        """Learn the count, ask for the last few events again, and return them in order."""
        self.run(3.1)
        counts = self.of("CURRENT_EVENT_SEQUENCE")
        if not counts:
            self.missing.append("CURRENT_EVENT_SEQUENCE")
            return []
        last = int(counts[-1].sequence)
        self.forget()
        self.send(RequestEvent((last - wanted + 1) % 65536, last, 1, 1))
        events = self.of("EVENT")
        if [event.sequence for event in events] != [(last - wanted + 1 + place) % 65536 for place in range(wanted)]:
            self.missing.append("EVENT")
        return events


def is_listed(heard: Message) -> bool:
    return bool(heard.get_type() == "PARAM_VALUE" and heard.param_id != "_HASH_CHECK")


def is_value(index: int) -> Callable[[Message], bool]:
    return lambda heard: heard.get_type() == "PARAM_VALUE" and heard.param_index == index


def of_plan(name: str, kind: int, seq: int | None = None) -> Callable[[Message], bool]:
    """Return whether a message is of a plan, and of an item of it; both ways to ask for one count alike."""
    return lambda heard: (
        heard.get_type().replace("REQUEST_INT", "REQUEST") == name
        and heard.mission_type == kind
        and (seq is None or heard.seq == seq)
    )
