"""A ground station that loads a ``.plan`` and uploads it, as QGroundControl does for each flavour."""

import json
from math import nan
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station
from vehicle_sim.parameters import Flavour

_FENCE, _RALLY = mavlink.MAV_MISSION_TYPE_FENCE, mavlink.MAV_MISSION_TYPE_RALLY
_VERTEX = {
    True: mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
    False: mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION,
}
_CIRCLE = {True: mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION, False: mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION}


def upload_plan(station: Station, content: bytes) -> None:
    """Upload mission, fence and rally points; all of them must be accepted."""
    document = json.loads(content)
    flavour = station.endpoint.table.flavour
    for mission_type, rows in enumerate((_mission(document, flavour), _fence(document), _rally(document))):
        station.send(mavlink.MAVLink_mission_count_message(1, 1, len(rows), mission_type))
        for seq, (frame, command, params, (latitude, longitude, height)) in enumerate(rows):
            x, y = round(latitude * 1e7), round(longitude * 1e7)
            station.send(
                mavlink.MAVLink_mission_item_int_message(
                    1, 1, seq, frame, command, 0, 1, *params, x, y, height, mission_type
                )
            )
        ack = station.last("MISSION_ACK")
        assert (ack.type, ack.mission_type) == (mavlink.MAV_MISSION_ACCEPTED, mission_type)


_Row = tuple[int, int, list[float], tuple[float, float, float]]


def _mission(document: dict[str, Any], flavour: Flavour) -> list[_Row]:
    mission = document["mission"]
    home: _Row = (0, mavlink.MAV_CMD_NAV_WAYPOINT, [0.0] * 4, tuple(mission["plannedHomePosition"]))
    rows = [home] if flavour is Flavour.ARDUPILOT else []
    # The file counts home as item 0; PX4 has none, so that its numbers are one less.
    for item in mission["items"]:
        params = [nan if value is None else value for value in item["params"][:4]]
        if item["command"] == mavlink.MAV_CMD_DO_JUMP and flavour is Flavour.PX4:
            params[0] -= 1
        rows.append((item["frame"], item["command"], params, tuple(item["params"][4:])))
    return rows


def _fence(document: dict[str, Any]) -> list[_Row]:
    fence, rows = document["geoFence"], []
    for area in fence["polygons"]:
        corners = area["polygon"]
        params = [float(len(corners)), 0.0, 0.0, 0.0]
        rows += [(0, _VERTEX[area["inclusion"]], params, (*corner, 0.0)) for corner in corners]
    for area in fence["circles"]:
        circle = area["circle"]
        rows.append((0, _CIRCLE[area["inclusion"]], [circle["radius"], 0.0, 0.0, 0.0], (*circle["center"], 0.0)))
    return rows


def _rally(document: dict[str, Any]) -> list[_Row]:
    points = document["rallyPoints"]["points"]
    return [(3, mavlink.MAV_CMD_NAV_RALLY_POINT, [0.0] * 4, tuple(point)) for point in points]
