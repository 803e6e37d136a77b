"""The rows of the check before the flight, as pure functions: what is judged how, by a table."""

import json
import math
from dataclasses import dataclass, replace
from typing import Any

import pytest

from mission.errors import SpecError
from mission.fly.preflight import ROWS, Findings, Judgement, Level, NoGoError, check_forced, judged
from mission.fly.preflight.rows import ARDUPILOT, PX4, Asked, Told, Value
from mission.fly.preflight.table import PARAMETERS
from mission.link.values import Fix, Wind
from mission.spec.battery import Battery

GO, UNKNOWN, CAUTION, NO_GO = Level.GO, Level.UNKNOWN, Level.CAUTION, Level.NO_GO
ASKED = Asked(
    speed_m_s=4.0,
    acceleration_m_s2=2.2,
    jerk_m_s3=4.0,
    tilt_rad=math.radians(25.0),
    yaw_rate_rad_s=math.radians(45.0),
    altitude_m=20.0,
    reach_m=140.0,
    air_s=180.0,
    setpoint_s=0.02,
    disturbance_m_s2=0.5,
)
DEFAULTS: dict[str, dict[str, float]] = {
    # As ArduCopter 4.7 and PX4 1.16 come.
    ARDUPILOT: {
        "WPNAV_SPEED": 1000, "WPNAV_ACCEL": 250, "PSC_JERK_XY": 5, "ANGLE_MAX": 3000, "PSC_ANGLE_MAX": 0,
        "ATC_SLEW_YAW": 6000, "ATC_RATE_Y_MAX": 0, "GUID_TIMEOUT": 3, "FS_GCS_ENABLE": 0, "MAV_GCS_SYSID": 255,
        "FS_THR_ENABLE": 1, "BATT_FS_LOW_ACT": 0, "BATT_FS_CRT_ACT": 0, "BATT_CAPACITY": 3300, "FENCE_ENABLE": 0,
        "FENCE_TYPE": 7, "FENCE_ACTION": 1, "FENCE_ALT_MAX": 100, "FENCE_RADIUS": 300, "FENCE_MARGIN": 2,
    },
    PX4: {
        "MPC_XY_VEL_MAX": 12, "MPC_ACC_HOR_MAX": 5, "MPC_TILTMAX_AIR": 45, "MPC_YAWRAUTO_MAX": 60,
        "MC_YAWRATE_MAX": 200, "COM_OF_LOSS_T": 1, "COM_OBL_RC_ACT": 0, "NAV_DLL_ACT": 0, "NAV_RCL_ACT": 2,
        "COM_LOW_BAT_ACT": 0, "BAT1_CAPACITY": -1, "GF_ACTION": 2, "GF_MAX_VER_DIST": 0, "GF_MAX_HOR_DIST": 0,
        "EKF2_MCOEF": 0.15, "EKF2_BCOEF_X": 100,
    },
}  # fmt: skip
TOLD = {
    autopilot: Told(
        autopilot=autopilot,
        parameters=DEFAULTS[autopilot],
        stand=Judgement(GO, "it stands 3 m from the start"),
        mode="HOLD",
        worst_ratio=0.3,
        fix=Fix((0.4, 0.7), 3, 12, 0.8),
        battery_percent=95.0,
        firmware=(4, 7, 0) if autopilot == ARDUPILOT else (1, 16, 1),
    )
    for autopilot in (ARDUPILOT, PX4)
}


def row(name: str, asked: Asked, told: Told) -> Judgement:
    (judge,) = (each.judge for each in ROWS if each.name == name)
    return judge(asked, told)


@dataclass(frozen=True)
class Case:
    """A row, what is otherwise than usual, and how it is judged, with words of the figure or of the advice."""

    name: str
    level: Level
    words: str
    parameters: dict[str, float] | None = None
    told: dict[str, Any] | None = None
    asked: dict[str, Any] | None = None
    without: tuple[str, ...] = ()


WINDY = {"wind": Wind(6.0, 270.0)}
CHARGED = {"battery": Battery(15.0, 0.2, 3300.0)}
BOTH = [
    Case("firmware", UNKNOWN, "does not tell", told={"firmware": None}),
    Case("mode", NO_GO, "armed", told={"busy": "it is armed"}),
    Case("estimator", NO_GO, "no position", told={"unready": "its estimator has no position yet"}),
    Case("estimator", NO_GO, "1.20", told={"worst_ratio": 1.2}),
    Case("estimator", CAUTION, "0.90", told={"worst_ratio": 0.9}),
    Case("estimator", UNKNOWN, "does not tell", told={"worst_ratio": None}),
    Case("satellites", NO_GO, "no place", told={"fix": Fix(None, 1, 0, 99.0)}),
    Case("satellites", NO_GO, "5 satellites", told={"fix": Fix(None, 3, 5, 1.0)}),
    Case("satellites", CAUTION, "8 satellites", told={"fix": Fix(None, 3, 8, 1.0)}),
    Case("satellites", CAUTION, "HDOP 2.5", told={"fix": Fix(None, 3, 12, 2.5)}),
    Case("satellites", GO, "a place", told={"fix": Fix(None, 3)}),
    Case("satellites", UNKNOWN, "receiver", told={"fix": None}),
    Case("origin", NO_GO, "5,000 km", told={"stand": Judgement(NO_GO, "5,000 km away", blames_file=True)}),
    Case("battery", NO_GO, "critical", told={"battery_critical": True}),
    Case("battery", UNKNOWN, "does not tell", told={"battery_percent": None}),
    Case("battery", CAUTION, "25 % left", told={"battery_percent": 25.0}),
    # 15 A for 180 s are 750 mAh; of 3300 mAh there are 2475 above the reserve at 95 %, and 726 at 42 %.
    Case("battery", GO, "750 mAh needed for 180 s at 15 A, 95 % left of 3300 mAh: 2475 above", asked=CHARGED),
    Case("battery", NO_GO, "726 above the reserve of 20 %", told={"battery_percent": 42.0}, asked=CHARGED),
    Case("battery", CAUTION, "without an end", asked=CHARGED | {"air_s": math.inf}),
    Case("wind", UNKNOWN, "no estimate"),
    Case("wind", GO, "the proof allows for 1.5", told=WINDY, asked={"disturbance_m_s2": 1.5}),
    Case("wind", CAUTION, "6.0 m/s from 270°", told=WINDY),
    Case("wind", NO_GO, "a lean of 25°", told={"wind": Wind(18.0, 0.0)}),
    Case("yaw-rate", GO, "allowed", asked={"yaw_rate_rad_s": None}),
    Case("yaw-rate", NO_GO, "80 °/s asked, 60 °/s allowed", asked={"yaw_rate_rad_s": math.radians(80.0)}),
    Case("speed", NO_GO, "14 m/s asked", asked={"speed_m_s": 14.0}),
    Case("acceleration", NO_GO, "6 m/s² asked", asked={"acceleration_m_s2": 6.0}),
    Case("tilt", CAUTION, "50 ° may be of use", asked={"tilt_rad": math.radians(50.0)}),
    Case("tilt", NO_GO, "45.6 ° asked", asked={"acceleration_m_s2": 10.0}),
]
ARDUPILOTS = [
    Case("firmware", NO_GO, "ArduPilot 3.6.12; 4.1", told={"firmware": (3, 6, 12)}),
    Case("firmware", CAUTION, "tried were 4.7", told={"firmware": (4, 5, 7)}),
    Case("battery", GO, "63 A", told={}),
    Case("speed", NO_GO, "set WPNAV_SPEED to 400 or more", parameters={"WPNAV_SPEED": 399}),
    Case("speed", GO, "4 m/s allowed (WPNAV_SPEED 400)", parameters={"WPNAV_SPEED": 400}),
    Case("speed", NO_GO, "set WP_SPD to 4 or more", parameters={"WP_SPD": 3}, without=("WPNAV_SPEED",)),
    Case("speed", UNKNOWN, "WPNAV_SPEED is not known", without=("WPNAV_SPEED",)),
    Case("acceleration", NO_GO, "set WPNAV_ACCEL to 220 or more", parameters={"WPNAV_ACCEL": 100}),
    Case("acceleration", GO, "WP_ACC 2.5", parameters={"WP_ACC": 2.5}, without=("WPNAV_ACCEL",)),
    Case("jerk", NO_GO, "set PSC_JERK_XY to 4 or more", parameters={"PSC_JERK_XY": 3}),
    Case("jerk", GO, "PSC_NE_JERK 5", parameters={"PSC_NE_JERK": 5}, without=("PSC_JERK_XY",)),
    Case("tilt", NO_GO, "set ANGLE_MAX to 1270 or more", parameters={"ANGLE_MAX": 1000}),
    Case("tilt", CAUTION, "set ATC_ANGLE_MAX to 25 or more", parameters={"ATC_ANGLE_MAX": 20}, without=("ANGLE_MAX",)),
    Case("tilt", NO_GO, "PSC_ANGLE_MAX 10", parameters={"PSC_ANGLE_MAX": 10}),
    Case("yaw-rate", NO_GO, "set ATC_SLEW_YAW to 4500 or more", parameters={"ATC_SLEW_YAW": 3000}),
    Case("yaw-rate", NO_GO, "ATC_RATE_Y_MAX 20", parameters={"ATC_RATE_Y_MAX": 20}),
    Case("yaw-rate", GO, "ATC_RATE_WPY_MAX 60", parameters={"ATC_RATE_WPY_MAX": 60}, without=("ATC_SLEW_YAW",)),
    Case("setpoints", GO, "3 s and 12 m", told={}),
    Case("setpoints", NO_GO, "set GUID_TIMEOUT to 1 s", parameters={"GUID_TIMEOUT": 0.1}),
    Case("setpoints", CAUTION, "links pause", parameters={"GUID_TIMEOUT": 0.3}),
    Case("setpoints", UNKNOWN, "GUID_TIMEOUT is not known", without=("GUID_TIMEOUT",)),
    Case("link-loss", CAUTION, "FS_GCS_ENABLE: 5 lands"),
    Case("link-loss", GO, "lands", parameters={"FS_GCS_ENABLE": 5}),
    Case("link-loss", CAUTION, "set SYSID_MYGCS to 255", parameters={"FS_GCS_ENABLE": 5, "SYSID_MYGCS": 1},
         without=("MAV_GCS_SYSID",)),
    Case("sticks-loss", CAUTION, "nothing", parameters={"FS_THR_ENABLE": 0}),
    Case("low-battery", CAUTION, "warns only"),
    Case("low-battery", NO_GO, "would fall", parameters={"BATT_FS_CRT_ACT": 5}),
    Case("low-battery", GO, "returns", parameters={"BATT_FS_LOW_ACT": 2, "BATT_FS_CRT_ACT": 1}),
    Case("fence", GO, "off (FENCE_ENABLE 0) until the flight sets its own"),
    Case("fence", CAUTION, "off", asked={"fenced": False}),
    Case("fence", GO, "on: a ceiling, a circle, areas", parameters={"FENCE_ENABLE": 1}),
    Case("fence", NO_GO, "set FENCE_ALT_MAX to 22 or more", parameters={"FENCE_ENABLE": 1, "FENCE_ALT_MAX": 20}),
    Case("fence", NO_GO, "140 m away from home", parameters={"FENCE_ENABLE": 1, "FENCE_RADIUS": 141}),
    Case("fence", GO, "on: areas", parameters={"FENCE_ENABLE": 1, "FENCE_TYPE": 4, "FENCE_ALT_MAX": 10}),
    Case("fence", CAUTION, "warns only", parameters={"FENCE_ENABLE": 1, "FENCE_ACTION": 0}),
    Case("fence", UNKNOWN, "FENCE_ENABLE is not known", without=("FENCE_ENABLE",)),
]  # fmt: skip
PX4S = [
    Case("firmware", NO_GO, "1.11 and later", told={"firmware": (1, 9, 2)}),
    Case("firmware", CAUTION, "tried were 1.16", told={"firmware": (1, 14, 3)}),
    Case("battery", UNKNOWN, "battery.capacity_mah", asked={"battery": Battery(15.0)}),
    Case("speed", NO_GO, "set MPC_XY_VEL_MAX to 4 or more", parameters={"MPC_XY_VEL_MAX": 3}),
    Case("acceleration", NO_GO, "set MPC_ACC_HOR_MAX to 2.2 or more", parameters={"MPC_ACC_HOR_MAX": 2}),
    Case("jerk", GO, "PX4 limits none", told={}),
    Case("tilt", NO_GO, "set MPC_TILTMAX_AIR to 12.7 or more", parameters={"MPC_TILTMAX_AIR": 12}),
    Case("tilt", CAUTION, "25 ° may be of use", parameters={"MPC_TILTMAX_AIR": 20}),
    Case("yaw-rate", NO_GO, "set MPC_YAWRAUTO_MAX to 45 or more", parameters={"MPC_YAWRAUTO_MAX": 30}),
    Case("yaw-rate", NO_GO, "MC_YAWRATE_MAX 30", parameters={"MC_YAWRATE_MAX": 30}),
    Case("setpoints", NO_GO, "set COM_OF_LOSS_T to 1 s", parameters={"COM_OF_LOSS_T": 0}),
    Case("setpoints", CAUTION, "60 s and 240 m", parameters={"COM_OF_LOSS_T": 60}),
    Case("setpoints", NO_GO, "disarms", parameters={"COM_OBL_RC_ACT": 7}),
    Case("setpoints", CAUTION, "Altitude", parameters={"COM_OBL_RC_ACT": 1}),
    Case("setpoints", GO, "not known here", parameters={"COM_OBL_RC_ACT": 12}),
    Case("link-loss", NO_GO, "would fall", parameters={"NAV_DLL_ACT": 5}),
    Case("link-loss", GO, "holds", parameters={"NAV_DLL_ACT": 1}),
    Case("sticks-loss", NO_GO, "disarms", parameters={"NAV_RCL_ACT": 6}),
    Case("low-battery", GO, "returns", parameters={"COM_LOW_BAT_ACT": 3}),
    Case("wind", GO, "push of about 1.1", told=WINDY, asked={"disturbance_m_s2": 1.2}),
    Case("fence", GO, "on", told={}),
    Case("fence", CAUTION, "off", parameters={"GF_ACTION": 0}, asked={"fenced": False}),
    Case("fence", NO_GO, "20 m high", parameters={"GF_MAX_VER_DIST": 15}),
    Case("fence", NO_GO, "set GF_MAX_HOR_DIST to 140 or more", parameters={"GF_MAX_HOR_DIST": 100}),
]
CASES = [(autopilot, case) for autopilot in (ARDUPILOT, PX4) for case in BOTH]
CASES += [(ARDUPILOT, case) for case in ARDUPILOTS] + [(PX4, case) for case in PX4S]


@pytest.mark.parametrize(("autopilot", "case"), CASES, ids=lambda value: getattr(value, "words", value))
def test_a_row_is_judged_by_what_is_known(autopilot: str, case: Case) -> None:
    usual = TOLD[autopilot]
    known = {name: value for name, value in usual.parameters.items() if name not in case.without}
    told = replace(usual, **{"parameters": known | (case.parameters or {})} | (case.told or {}))
    judgement = row(case.name, replace(ASKED, **case.asked or {}), told)
    assert judgement.level is case.level
    assert case.words in f"{judgement.figure} | {judgement.advice}"
    if case.level is NO_GO and case.name != "origin":
        assert judgement.advice, "a no-go says what to do"


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_as_they_come_both_autopilots_are_go(autopilot: str) -> None:
    findings = judged(ASKED, TOLD[autopilot])
    assert findings.go
    assert set(findings.of(CAUTION)) <= {"link-loss", "low-battery"}
    assert findings.of(UNKNOWN) == ("wind",)
    assert findings.forced_text == ""


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_a_vehicle_that_tells_nothing_is_not_known_and_is_not_kept_from_flying(autopilot: str) -> None:
    findings = judged(ASKED, Told(autopilot))
    assert findings.go
    assert len(findings.of(UNKNOWN)) > 12
    assert not findings.of(CAUTION)


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_all_parameters_that_a_row_is_judged_by_are_read(autopilot: str) -> None:
    """Each parameter of the cases, once it alone is let go of, is one that is asked for."""
    read = {name for names in PARAMETERS[autopilot] for name in names}
    used = {name for case in (ARDUPILOTS if autopilot == ARDUPILOT else PX4S) for name in case.parameters or {}}
    assert used | set(DEFAULTS[autopilot]) <= read
    assert all(len(name) <= 16 for name in read)


ELSEWHERE = Judgement(NO_GO, "in another town", "see `origin`", blames_file=True)


def blamed(*rows: str, forced: tuple[str, ...] = ()) -> Findings:
    told = TOLD[PX4]
    told = replace(told, stand=ELSEWHERE) if "origin" in rows else told
    told = replace(told, fix=Fix(None, 0, 3)) if "satellites" in rows else told
    told = replace(told, wind=Wind(30.0, 0.0)) if "wind" in rows else told
    return judged(ASKED, told, forced)


@pytest.mark.parametrize(
    ("rows", "exit_code"),
    [(("origin",), 2), (("satellites",), 4), (("origin", "satellites"), 4)],
)
def test_the_file_is_to_blame_where_nothing_else_is(rows: tuple[str, ...], exit_code: int) -> None:
    findings = blamed(*rows)
    assert not findings.go
    error = NoGoError(findings)
    assert error.exit_code == exit_code
    for name in rows:
        assert f"{name}: " in str(error)


def test_each_no_go_is_overridden_by_its_own_name_and_said() -> None:
    both = ("wind", "satellites")
    assert [each.row for each in blamed(*both, forced=("wind",)).forbidding] == ["satellites"]
    findings = blamed(*both, forced=("wind", "satellites", "tilt"))
    assert findings.go
    assert findings.forced_text.startswith("flown against the check before the flight: satellites (no place, 3 sat")
    assert "wind (30.0 m/s from 0°" in findings.forced_text
    assert "tilt" not in findings.forced_text  # it was no no-go
    values = json.loads(json.dumps(findings.values()))
    assert [each["row"] for each in values["rows"]] == [each.name for each in ROWS]
    assert [each["row"] for each in values["rows"] if each["forced"]] == ["satellites", "wind"]


def test_a_place_that_nothing_can_be_planned_from_does_not_give_way() -> None:
    findings = blamed("origin", forced=("origin",))
    assert [(each.row, each.firm) for each in findings.forbidding] == [("origin", True)]
    with pytest.raises(SpecError, match="does not give way"):
        check_forced(("origin",))


def test_a_name_that_no_row_has_is_refused_with_those_that_there_are() -> None:
    check_forced(("battery", "fence"))
    with pytest.raises(SpecError) as caught:
        check_forced(("batery", "sunshine"))
    nearest, all_there_are = (fault.hint for fault in caught.value.faults)
    assert nearest == "did you mean `battery`?"
    assert all(row.name in all_there_are for row in ROWS if not row.firm)


@pytest.mark.parametrize("unit", [1.0, 0.01, math.radians(1.0), math.radians(0.01)])
@pytest.mark.parametrize("value", [0.1, 1.0, 2.2, 12.637, 99.95, 140.0])
def test_what_is_to_be_copied_is_never_less_than_what_is_needed(value: float, unit: float) -> None:
    copied = float(Value("NAME", 0.0, unit).at_least(value)) * unit
    assert value * (1.0 - 1e-8) <= copied <= 1.011 * value
