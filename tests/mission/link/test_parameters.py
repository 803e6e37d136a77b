"""Parameters are read by name from a vehicle of either flavour, over good links and bad ones."""

from collections import Counter

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.messages import Codec
from mission.link.parameters import ParameterReading
from mission.link.services import parameter_request
from mission.link.values import ParameterValue
from tests.support.lockstep import LockstepVehicle, vehicle_of

WANTED = {
    "ardupilot": (("WP_SPD", "WPNAV_SPEED"), ("GUID_TIMEOUT",), ("FS_GCS_ENABLE",), ("NO_SUCH",)),
    "px4": (("MPC_XY_VEL_MAX",), ("COM_OF_LOSS_T",), ("NAV_RCL_ACT",), ("COM_WIND_MAX",), ("NO_SUCH",)),
}
EXPECTED = {
    "ardupilot": {"WPNAV_SPEED": 1000.0, "GUID_TIMEOUT": 3.0, "FS_GCS_ENABLE": 0.0},
    "px4": {"MPC_XY_VEL_MAX": 12.0, "COM_OF_LOSS_T": 1.0, "NAV_RCL_ACT": 2.0, "COM_WIND_MAX": -1.0},
}


def reading_of(flavour: str) -> ParameterReading:
    reading = ParameterReading()
    reading.wanted = WANTED
    reading.begin(flavour)
    return reading


@pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
def test_values_come_as_the_flavour_sends_them_and_what_does_not_come_ends_the_wait(flavour: str) -> None:
    vehicle, codec, reading = LockstepVehicle(vehicle_of(flavour)), Codec(255, 191), reading_of(flavour)
    asked: Counter[str] = Counter()
    while not reading.complete:
        for name in reading.due(vehicle.now_s()):
            asked[name] += 1
            vehicle.send(codec.packed(parameter_request(1, name)))
        for data in vehicle.receive(0.05):
            for received in codec.decode(data):
                if isinstance(received.body, ParameterValue):
                    reading.take(received.body)
        assert vehicle.now_s() < 10.0
    values = {name: body.value(bytewise=flavour == "px4") for name, body in reading.values.items()}
    assert values == EXPECTED[flavour]
    assert asked["NO_SUCH"] > 3
    assert asked["GUID_TIMEOUT" if flavour == "ardupilot" else "COM_OF_LOSS_T"] == 1


def test_a_lost_answer_is_asked_for_again_and_a_burst_is_no_longer_than_what_a_vehicle_keeps() -> None:
    reading = ParameterReading()
    names = tuple((f"P{number}",) for number in range(30))
    reading.wanted = {"px4": names}
    reading.begin("px4")
    asked: Counter[str] = Counter()
    for step in range(200):
        due = reading.due(0.05 * step)
        assert len(due) <= 10
        for name in due:
            asked[name] += 1
            if asked[name] == 3:  # the first two are lost
                reading.take(ParameterValue(name, 1.0, 0, is_integer=False))
    assert reading.complete
    assert set(asked.values()) == {3}
    assert set(reading.values) == {name for (name,) in names}


def test_integers_of_px4_are_bytes_and_those_of_ardupilot_numbers() -> None:
    codec = Codec(255, 191)
    sender = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    by_bytes = mavlink.MAVLink_param_value_message(b"NAV_DLL_ACT", 2.802596928649634e-45, 6, 1, 0).pack(sender)
    by_value = mavlink.MAVLink_param_value_message(b"FS_GCS_ENABLE", 5.0, 2, 1, 0).pack(sender)
    bodies = [received.body for received in codec.decode(bytes(by_bytes) + bytes(by_value))]
    assert [body.value(bytewise=way) for body, way in zip(bodies, (True, False), strict=True)] == [2.0, 5.0]  # type: ignore[union-attr]
    real = mavlink.MAVLink_param_value_message(b"COM_OF_LOSS_T", 1.5, 9, 1, 0).pack(sender)
    (body,) = (received.body for received in codec.decode(bytes(real)))
    assert isinstance(body, ParameterValue)
    assert body.value(bytewise=True) == 1.5
