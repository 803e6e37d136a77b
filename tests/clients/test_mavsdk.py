"""MAVSDK, both versions, takes the vehicle for an ArduPilot or a PX4: discovery to landing."""

from typing import TYPE_CHECKING

import pytest

from tests.clients.pairs import paired
from tests.clients.scenarios import HEIGHT_M, LAT_DEG, RATES, REAL, STREAMS, WHOLE
from vehicle_sim.parameters import Flavour

if TYPE_CHECKING:
    from tests.clients.conftest import Facts, Play

pytestmark = pytest.mark.timeout(400)  # the first test of a machine installs the clients

WELL = {
    "is_gyrometer_calibration_ok",
    "is_accelerometer_calibration_ok",
    "is_magnetometer_calibration_ok",
    "is_local_position_ok",
    "is_global_position_ok",
    "is_home_position_ok",
    "is_armable",
}


def failures(facts: "Facts") -> dict[str, str]:
    return {topic: value for topic, value in facts.items() if topic.endswith(": failed")}


@paired({3: Flavour.PX4, 4: Flavour.ARDUPILOT})
def test_discovery_health_and_telemetry(play: "Play", version: int, flavour: str) -> None:
    facts = play(version, flavour, "look")
    is_px4 = flavour == "px4"
    assert facts["connected"] is True
    if version == 4:
        assert facts["autopilot"] == ("PX4" if is_px4 else "ARDUPILOT")
        assert facts["vehicle"] == "MULTICOPTER"
        assert facts["system"] == [1, [1]]
    software = facts["version"]
    numbers = [software[f"flight_sw_{part}"] for part in ("major", "minor", "patch")]
    assert numbers == ([1, 16, 1] if is_px4 else [4, 7, 0])
    assert facts["product"]["vendor_id"] == 0
    assert facts["identification"]["legacy_uid"] == 1

    assert facts["all well"] is True
    assert {name for name, is_well in facts["health"].items() if is_well} == WELL
    assert all(facts[f"rate of {name}"] is True for name in RATES)

    assert not {name for name in STREAMS if name not in facts}, failures(facts)
    assert facts["position"]["latitude_deg"] == pytest.approx(47.39774, abs=1e-4)
    assert facts["position"]["relative_altitude_m"] == pytest.approx(0.0, abs=1.0)
    assert facts["home"]["longitude_deg"] == pytest.approx(8.54559, abs=1e-4)
    assert facts["home"]["absolute_altitude_m"] == pytest.approx(488.0, abs=2.0)
    assert (facts["armed"], facts["in_air"], facts["landed_state"]) == (False, False, "ON_GROUND")
    assert facts["flight_mode"] == ("HOLD" if is_px4 else "STABILIZED")
    assert abs(facts["attitude_euler"]["roll_deg"]) < 3.0
    assert facts["attitude_quaternion"]["w"] == pytest.approx(1.0, abs=0.01)
    # One sample each: as PX4 the gyros have a noise of 0.04 rad/s, the accelerometers of 0.4 m/s2.
    assert abs(facts["attitude_angular_velocity_body"]["yaw_rad_s"]) < 0.3
    assert abs(facts["velocity_ned"]["north_m_s"]) < 0.5
    assert abs(facts["position_velocity_ned"]["position"]["east_m"]) < 3.0
    assert facts["gps_info"]["fix_type"] == "FIX_3D"
    assert facts["gps_info"]["num_satellites"] >= 6
    assert facts["raw_gps"]["latitude_deg"] == pytest.approx(47.39774, abs=1e-4)
    assert 11.0 < facts["battery"]["voltage_v"] < 13.0
    assert facts["battery"]["remaining_percent"] > 98.0
    assert min(facts["heading"]["heading_deg"], 360.0 - facts["heading"]["heading_deg"]) < 5.0
    assert facts["unix_epoch_time"] > 1.7e15
    assert facts["origin"]["latitude_deg"] == pytest.approx(47.39774, abs=1e-4)
    assert facts["imu"]["acceleration_frd"]["down_m_s2"] == pytest.approx(-9.8, abs=2.8)
    assert facts["flight"]["flight_uid"] == facts["flight"]["duration_since_arming_ms"] == 0
    assert facts["flight"]["time_boot_ms"] > 0
    if version == 3 and is_px4:  # which has made sense of the vehicle's own file of events
        assert facts["report"]["current_mode_intention"]["mode_name"] == "Hold"
        problems = {problem["message"] for problem in facts["report"]["all_problems"]}
        assert problems == {"No offboard signal", "No valid mission available", "No manual control input"}
    px4_only = {"odometry", "altitude"}
    assert {name for name in px4_only if name in facts} == (px4_only if is_px4 else set())


@paired({3: Flavour.ARDUPILOT, 4: Flavour.PX4})
def test_parameters_plans_and_arming(play: "Play", version: int, flavour: str) -> None:
    facts = play(version, flavour, "configure")
    is_px4 = flavour == "px4"
    # MAVSDK makes missions of items relative to home only, and the first of ArduPilot's is home itself.
    assert set(failures(facts)) == (set() if is_px4 else {"mission down: failed"})

    whole = {one["name"]: one["value"] for one in facts["all parameters"]["int_params"]}
    real = {one["name"]: one["value"] for one in facts["all parameters"]["float_params"]}
    assert whole["MAV_SYS_ID" if is_px4 else "MAV_SYSID"] == 1
    assert facts["whole"] == whole[WHOLE[is_px4]] + 1
    assert facts["real"] == pytest.approx(real[REAL[is_px4]] + 0.5)

    (polygon,), (circle,) = facts["fence down"]["polygons"], facts["fence down"]["circles"]
    assert polygon["fence_type"] == "INCLUSION"
    assert [point["latitude_deg"] for point in polygon["points"]] == pytest.approx(
        [LAT_DEG - 0.01, LAT_DEG + 0.01, LAT_DEG + 0.01, LAT_DEG - 0.01], abs=1e-7
    )
    assert (circle["fence_type"], circle["radius"]) == ("EXCLUSION", 20.0)
    assert facts["no fence"] == {"polygons": [], "circles": []}

    items = facts["mission items"]
    assert [item["command"] for item in items] == [16, 178, 16, 178, 93, 16, 178]
    assert [item["seq"] for item in items] == list(range(7))
    assert items[0]["frame"] == (0 if not is_px4 else items[2]["frame"])
    assert items[2]["x"] == round((LAT_DEG + 1e-4) * 1e7)
    assert facts["mission finished"] is False
    if is_px4:
        points = facts["mission down"]["mission_items"]
        assert [point["speed_m_s"] for point in points] == [5.0, 4.0, 5.0]
        assert [point["relative_altitude_m"] for point in points] == [HEIGHT_M] * 3
        assert points[1]["loiter_time_s"] == 1.0
    assert [item["x"] for item in facts["raw down"]][1:] == [round((LAT_DEG + 1e-4) * 1e7)] * 2
    assert len(facts["raw empty"]) == (0 if is_px4 else 1)
    assert [item["command"] for item in facts["rally down"]] == [5100]
    assert facts["logs"] in (None, "NO_LOGFILES")

    assert facts["killed"] is False
    assert facts["terminated"] is False
    assert facts["arm after termination"] == ("COMMAND_DENIED" if is_px4 else "FAILED")


@paired({3: Flavour.PX4, 4: Flavour.ARDUPILOT})
def test_action_and_offboard(play: "Play", version: int, flavour: str) -> None:
    facts = play(version, flavour, "fly")
    assert not failures(facts)
    assert facts["offboard without a setpoint"] == "NO_SETPOINT_SET"
    assert facts["take-off altitude"] == HEIGHT_M
    assert facts["disarm in the air"] == ("COMMAND_DENIED" if flavour == "px4" else "FAILED")
    for topic in ("arm", "take off", "set speed", "go", "hold", "offboard", "stop", "return", "land"):
        assert facts[topic] is True, topic
    assert facts["offboard is active"] is True
    assert facts["up"]["relative_altitude_m"] < HEIGHT_M + 1.0
    assert facts["disarmed"] is False
    assert facts["stands"] is False
