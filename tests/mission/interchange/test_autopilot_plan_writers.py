"""Files for autopilots: as QGroundControl and pymavlink read them, and as they are read back here."""

import json
from pathlib import Path
from typing import Any

import pytest
from pymavlink import mavutil, mavwp
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.geometry.geodesy import LatLon
from mission.interchange.autopilot_plan import (
    AS_IT_IS,
    EVER_AGAIN,
    AutopilotPlan,
    Command,
    FenceCircle,
    FencePolygon,
    Item,
)
from mission.interchange.autopilot_plan_writers import qgroundcontrol_plan, waypoint_table
from mission.interchange.features import Polygon, Role, Spot
from mission.interchange.reading import read_drawing

HOME, AWAY, FAR = LatLon(-35.363262, 149.165237), LatLon(-35.362881123, 149.165222987), LatLon(-35.3641, 149.1661)
SQUARE = (LatLon(-35.37, 149.16), LatLon(-35.37, 149.17), LatLon(-35.36, 149.17), LatLon(-35.36, 149.16))
PLAN = AutopilotPlan(
    home=HOME,
    items=(
        Item(Command.TAKEOFF, (0.0, 0.0, 0.0, AS_IT_IS), HOME, 20.0),
        Item(Command.CHANGE_SPEED, (1.0, 4.5, -1.0, 0.0)),
        Item(Command.WAYPOINT, (3.0, 0.5, 0.0, AS_IT_IS), AWAY, 20.0),
        Item(Command.WAYPOINT, (0.0, 0.5, 0.0, AS_IT_IS), FAR, 20.0),
        Item(Command.JUMP, (2.0, EVER_AGAIN, 0.0, 0.0)),
        Item(Command.LAND, (0.0, 0.0, 0.0, AS_IT_IS), FAR),
    ),
    fence=(FencePolygon(inclusion=True, corners=SQUARE), FenceCircle(inclusion=False, centre=FAR, radius_m=12.5)),
    rally=((HOME, 20.0),),
    speed_m_s=4.5,
)


@pytest.fixture
def document() -> dict[str, Any]:
    loaded: dict[str, Any] = json.loads(qgroundcontrol_plan(PLAN, firmware="px4"))
    return loaded


def test_a_plan_has_the_keys_and_versions_that_qgroundcontrol_asks_for(document: dict[str, Any]) -> None:
    assert {key: document[key] for key in ("fileType", "groundStation", "version")} == {
        "fileType": "Plan",
        "groundStation": "QGroundControl",
        "version": 1,
    }
    assert (document["mission"]["version"], document["mission"]["firmwareType"]) == (2, 12)
    assert (document["mission"]["vehicleType"], document["mission"]["globalPlanAltitudeMode"]) == (2, 1)
    assert document["mission"]["plannedHomePosition"] == [-35.363262, 149.165237, 0.0]
    assert document["mission"]["hoverSpeed"] == 4.5
    assert (document["geoFence"]["version"], document["rallyPoints"]["version"]) == (2, 2)
    (polygon,), (circle,) = document["geoFence"]["polygons"], document["geoFence"]["circles"]
    assert polygon == {"inclusion": True, "polygon": [[p.latitude_deg, p.longitude_deg] for p in SQUARE], "version": 1}
    assert circle == {"circle": {"center": [-35.3641, 149.1661], "radius": 12.5}, "inclusion": False, "version": 1}
    assert document["rallyPoints"]["points"] == [[-35.363262, 149.165237, 20.0]]


def test_an_item_with_a_place_has_its_height_thrice_as_qgroundcontrol_saves_it(document: dict[str, Any]) -> None:
    assert document["mission"]["items"][2] == {
        "AMSLAltAboveTerrain": None,
        "Altitude": 20.0,
        "AltitudeMode": 1,
        "autoContinue": True,
        "command": 16,
        "doJumpId": 3,
        "frame": 3,
        "params": [3.0, 0.5, 0.0, None, -35.362881123, 149.165222987, 20.0],
        "type": "SimpleItem",
    }


def test_an_item_without_a_place_has_no_height(document: dict[str, Any]) -> None:
    speed, jump = document["mission"]["items"][1], document["mission"]["items"][4]
    assert set(speed) == {"autoContinue", "command", "doJumpId", "frame", "params", "type"}
    assert (speed["frame"], speed["params"]) == (2, [1.0, 4.5, -1.0, 0.0, 0.0, 0.0, 0.0])
    # A jump names the `doJumpId` of its target.
    assert jump["params"][:2] == [document["mission"]["items"][2]["doJumpId"], -1.0]


@pytest.fixture
def loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> mavwp.MAVWPLoader:
    monkeypatch.setattr(mavutil, "mavlink", mavlink)
    file = tmp_path / "mission.waypoints"
    file.write_bytes(waypoint_table(PLAN))
    loader = mavwp.MAVWPLoader()
    assert loader.load(str(file)) == 7
    return loader


def test_pymavlink_reads_the_table_as_it_was_meant(loaded: mavwp.MAVWPLoader) -> None:
    items = [loaded.wp(i) for i in range(loaded.count())]
    assert [item.seq for item in items] == list(range(7))
    assert [item.current for item in items] == [1, 0, 0, 0, 0, 0, 0]
    assert [item.autocontinue for item in items] == [1] * 7
    assert [(item.frame, item.command) for item in items] == [
        (mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_CMD_NAV_WAYPOINT),
        (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_CMD_NAV_TAKEOFF),
        (mavlink.MAV_FRAME_MISSION, mavlink.MAV_CMD_DO_CHANGE_SPEED),
        (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_CMD_NAV_WAYPOINT),
        (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_CMD_NAV_WAYPOINT),
        (mavlink.MAV_FRAME_MISSION, mavlink.MAV_CMD_DO_JUMP),
        (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_CMD_NAV_LAND),
    ]
    away = items[3]
    assert (away.x, away.y, away.z) == (AWAY.latitude_deg, AWAY.longitude_deg, 20.0)
    assert (away.param1, away.param2, away.param3, away.param4) == (3.0, 0.5, 0.0, 0.0)
    # Item 0 is home, so that the third item of the mission has number 3.
    assert (items[5].param1, items[5].param2) == (3.0, -1.0)


def test_pymavlink_follows_the_jump_to_where_the_lap_begins(loaded: mavwp.MAVWPLoader) -> None:
    assert loaded.view_indexes()[:5] == [0, 1, 3, 4, 3]


def test_a_plan_is_read_back() -> None:
    drawing = read_drawing(qgroundcontrol_plan(PLAN, firmware="ardupilot"))
    shapes = {feature.name: (feature.role, feature.shapes) for feature in drawing.features}
    ring = Polygon(tuple((p.longitude_deg, p.latitude_deg) for p in SQUARE))
    assert shapes["inclusion_polygon_1"] == (Role.BOUNDARY, (ring,))
    assert shapes["exclusion_circle_1"] == (Role.RESTRICTED, (Spot((149.1661, -35.3641), 12.5),))
    assert shapes["rally_1"] == (Role.HOME, (Spot((149.165237, -35.363262)),))
    assert drawing.route == ((149.165222987, -35.362881123), (149.1661, -35.3641))
    assert (drawing.altitude_m, drawing.speed_m_s) == (20.0, 4.5)


def test_a_table_is_read_back() -> None:
    drawing = read_drawing(waypoint_table(PLAN))
    (home,) = drawing.features
    assert (home.role, home.shapes) == (Role.HOME, (Spot((149.165237, -35.363262)),))
    assert drawing.route == ((149.165222987, -35.362881123), (149.1661, -35.3641))
    assert (drawing.altitude_m, drawing.speed_m_s) == (20.0, 4.5)
