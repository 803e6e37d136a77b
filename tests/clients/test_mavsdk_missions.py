"""MAVSDK, both versions, flies missions: start, progress, pause, and on to the end."""

from typing import TYPE_CHECKING

import pytest

from tests.clients.environments import VERSIONS
from tests.support.usual_cases import sampled

if TYPE_CHECKING:
    from tests.clients.conftest import Play

pytestmark = pytest.mark.timeout(400)  # the first test of a machine installs the clients


@sampled("version", VERSIONS, [3])
def test_a_mission(play: "Play", version: int) -> None:
    facts = play(version, "px4", "fly_mission")
    assert not {topic: value for topic, value in facts.items() if topic.endswith(": failed")}
    assert facts["all reached"] == {"current": 3, "total": 3}
    assert facts["finished"] is True
    assert facts["disarmed"] is False


@sampled("version", VERSIONS, [4])
def test_a_raw_mission(play: "Play", version: int) -> None:
    facts = play(version, "ardupilot", "fly_raw_mission")
    assert not {topic: value for topic, value in facts.items() if topic.endswith(": failed")}
    assert facts["all reached"]["total"] >= 2
    assert facts["disarmed"] is False
