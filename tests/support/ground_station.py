"""QGroundControl's manners: it asks, waits for the answer so long and no longer, and asks again for what is missing.

Time-outs: 3 s for an acknowledgement of a command, 5 s for the first parameter, 1.5 s for a mission message, 1 s for a
file transfer.
"""

from collections.abc import Callable, Iterator
from itertools import cycle
from struct import pack, unpack_from

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.flavour import Rates

COMMAND_S = 3.0
PLAN_S = 1.5
FILE_S = 1.0
ACK, NAK = 128, 129
FIRST_PARAMETER_S = 5.0
SILENCE_S = 3.0
BATCH, TRIES = 10, 5


class GroundStation(Station):
    """A station that wants an answer to each of its requests in time."""

    def __init__(self, flavour: Flavour) -> None:
        super().__init__(endpoint_of(flavour), rates=Rates.GROUND_STATION)
        self.flavour = flavour
        self._file_sequence = 0

    def asks(self, request: Message, answers: Callable[[Message], bool], within_s: float) -> Message:
        """Send a request and return the first answer to it."""
        self.forget()
        self.send(request)
        found: list[Message] = []

        def answered() -> bool:
            found[:] = [message for message in self.heard if answers(message)]
            return bool(found)

        self.wait_until(answered, within_s=within_s)
        return found[0]

    def commands(self, command: int, *params: float, component: int = 1) -> int:
        """Send a command and return the result of its acknowledgement, which is addressed to this station."""
        seven = (*params, *(0.0,) * (7 - len(params)))
        ack = self.asks(
            mavlink.MAVLink_command_long_message(1, component, command, 0, *seven),
            lambda message: message.get_type() == "COMMAND_ACK" and message.command == command,
            COMMAND_S,
        )
        assert (ack.target_system, ack.target_component) == (255, 190)
        return int(ack.result)

    def requests(self, message_id: int, index: int = 0) -> Message | None:
        """Ask for a message; None where the vehicle says that it has no such message."""
        if self.commands(mavlink.MAV_CMD_REQUEST_MESSAGE, message_id, index) != mavlink.MAV_RESULT_ACCEPTED:
            return None
        return next(message for message in self.heard if message.get_msgId() == message_id)

    def plan(self, mission_type: int) -> list[Message]:
        """Download a plan."""

        def of_plan(kind: str) -> Callable[[Message], bool]:
            return lambda message: message.get_type() == kind and message.mission_type == mission_type

        request_list = mavlink.MAVLink_mission_request_list_message(1, 1, mission_type)
        count = self.asks(request_list, of_plan("MISSION_COUNT"), PLAN_S).count
        items = []
        for seq in range(count):
            request = mavlink.MAVLink_mission_request_int_message(1, 1, seq, mission_type)
            items.append(self.asks(request, of_plan("MISSION_ITEM_INT"), PLAN_S))
        self.send(mavlink.MAVLink_mission_ack_message(1, 1, mavlink.MAV_MISSION_ACCEPTED, mission_type))
        return items

    def file_request(
        self, opcode: int, data: bytes = b"", *, session: int = 0, offset: int = 0, size: int = 0
    ) -> bytes:
        """Send one request of the file transfer protocol and return the payload of its answer."""
        self._file_sequence = sequence = (self._file_sequence + 1) & 0xFFFF
        header = pack("<HBBBBBxI", sequence, session, opcode, size or len(data), 0, 0, offset)
        payload = (header + data).ljust(251, b"\0")
        answer = self.asks(
            mavlink.MAVLink_file_transfer_protocol_message(0, 1, 1, payload),
            lambda message: (
                message.get_type() == "FILE_TRANSFER_PROTOCOL"
                and unpack_from("<H", bytes(message.payload))[0] == (sequence + 1) & 0xFFFF
            ),
            FILE_S,
        )
        assert (answer.target_system, answer.target_component) == (255, 190)
        answered = bytes(answer.payload)
        assert answered[3] in (ACK, NAK)
        assert answered[5] == opcode
        return answered

    def parameters(self, lost: Iterator[bool] | None = None) -> dict[str, Message]:
        """Load all parameters as the parameter manager does, over a line that loses what `lost` says, each in turn.

        A list; 3 s after its last value what is missing by index, ten at a time, each five times at most.
        """
        lost = lost or cycle([False])
        values: dict[int, Message] = {}
        count = 0

        def take() -> None:
            nonlocal count
            for message in self.of("PARAM_VALUE"):
                if message.param_id != "_HASH_CHECK" and not next(lost):
                    values[message.param_index], count = message, message.param_count
            self.forget()

        self.forget()
        self.send(mavlink.MAVLink_param_request_list_message(1, mavlink.MAV_COMP_ID_ALL))
        silent_s = 0.0
        while silent_s < (SILENCE_S if values else FIRST_PARAMETER_S):
            before = len(values)
            self.run(0.1)
            take()
            silent_s = silent_s + 0.1 if len(values) == before else 0.0
        assert values
        tries = dict.fromkeys(range(count), TRIES)
        while missing := [index for index in range(count) if index not in values][:BATCH]:
            for index in missing:
                assert tries[index], f"parameter {index} did not come in {TRIES} tries"
                tries[index] -= 1
                self.send(mavlink.MAVLink_param_request_read_message(1, 1, b"", index))
            take()
        return {message.param_id: message for message in values.values()}
