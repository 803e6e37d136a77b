"""The folder that keeps the logs."""

from pathlib import Path

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.recorded import entries_of
from tests.support.station import Station, endpoint_of
from vehicle_sim.errors import ConfigurationError
from vehicle_sim.parameters import Flavour
from vehicle_sim.server.log_folder import keep_logs


def arm_for(station: Station, seconds: float) -> None:
    station.wait_for_position()
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_ACCEPTED
    station.run(seconds)
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0) == mavlink.MAV_RESULT_ACCEPTED
    station.run(0.1)


def test_each_log_is_written_once_it_has_ended_and_nothing_is_replaced(tmp_path: Path) -> None:
    folder, said = tmp_path / "logs", list[str]()
    stations = [Station(endpoint_of(Flavour.ARDUPILOT)), Station(endpoint_of(Flavour.PX4, system_id=2))]
    stations[1].mav.srcSystem = 255
    folder.mkdir()
    (folder / "system1-0004.tlog").write_bytes(b"from an earlier flight")
    keep_logs(folder, [station.endpoint for station in stations], said.append)
    arm_for(stations[0], 1.0)
    arm_for(stations[0], 2.0)
    assert sorted(path.name for path in folder.iterdir()) == [
        "system1-0004.tlog",
        "system1-0005.tlog",
        "system1-0006.tlog",
    ]
    assert (folder / "system1-0004.tlog").read_bytes() == b"from an earlier flight"
    for number, log in enumerate(stations[0].endpoint.recorder.logs, 5):
        data = (folder / f"system1-{number:04d}.tlog").read_bytes()
        assert data == bytes(log.data)
        assert {message.get_srcSystem() for _, message in entries_of(data)} == {1}
    stations[1].endpoint.recorder.begin()
    stations[1].endpoint.recorder.finish()
    assert (folder / "system2-0001.tlog").exists()
    assert said == []


def test_a_folder_that_cannot_be_is_told_before_the_flight(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for folder in (tmp_path / "file", tmp_path / "none" / "below"):
        with pytest.raises(ConfigurationError, match="name a folder for the logs"):
            keep_logs(folder, [], print)


def test_a_folder_that_is_gone_is_told_in_flight_and_the_flight_goes_on(tmp_path: Path) -> None:
    folder, said = tmp_path / "logs", list[str]()
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    keep_logs(folder, [station.endpoint], said.append)
    folder.rmdir()
    arm_for(station, 1.0)
    (sentence,) = said
    assert "log 1 is not kept" in sentence
    assert len(station.endpoint.recorder.logs) == 1
