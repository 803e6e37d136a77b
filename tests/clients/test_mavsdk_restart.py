"""MAVSDK, both versions, restarts the vehicle and finds it again."""

from typing import TYPE_CHECKING

import pytest

from tests.clients.pairs import paired
from vehicle_sim.parameters import Flavour

if TYPE_CHECKING:
    from tests.clients.conftest import Play


@pytest.mark.timeout(400)  # the first test of a machine installs the clients
@paired({3: Flavour.ARDUPILOT, 4: Flavour.PX4})
def test_a_restart(play: "Play", version: int, flavour: str) -> None:
    facts = play(version, flavour, "restart")
    assert not {topic: value for topic, value in facts.items() if topic.endswith(": failed")}
    assert facts["first mode"] == ("HOLD" if flavour == "px4" else "STABILIZED")
    assert facts["arm"] is True
    assert facts["disarmed"] is False
