"""Autopilot plans as files: QGroundControl's ``.plan``, and the table of waypoints that all ground stations read.

https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/plan.html and
https://mavlink.io/en/file_formats/#mission_plain_text_file.
"""

import json
import math
from typing import Any, Final

from mission.geometry.geodesy import LatLon
from mission.interchange.autopilot_plan import AutopilotPlan, Command, FenceCircle, FencePolygon, Frame, Item

FIRMWARE: Final = {"ardupilot": 3, "px4": 12}
"""Values of MAV_AUTOPILOT, by which a ground station knows whether a plan was made for the vehicle that it talks to."""

_MULTICOPTER: Final = 2
_RELATIVE: Final = 1
_DIGITS: Final = 9
_HOME_ITEMS: Final = 1
"""Items are counted from 1 in both formats: number 0 is home."""


def qgroundcontrol_plan(plan: AutopilotPlan, *, firmware: str) -> bytes:
    """The plan as QGroundControl writes it; ``firmware`` is a key of ``FIRMWARE``."""
    areas = plan.fence
    document = {
        "fileType": "Plan",
        "geoFence": {
            "circles": [
                {
                    "circle": {"center": _pair(area.centre), "radius": area.radius_m},
                    "inclusion": area.inclusion,
                    "version": 1,
                }
                for area in areas
                if isinstance(area, FenceCircle)
            ],
            "polygons": [
                {"inclusion": area.inclusion, "polygon": [_pair(corner) for corner in area.corners], "version": 1}
                for area in areas
                if isinstance(area, FencePolygon)
            ],
            "version": 2,
        },
        "groundStation": "QGroundControl",
        "mission": {
            "cruiseSpeed": plan.speed_m_s,
            "firmwareType": FIRMWARE[firmware],
            "globalPlanAltitudeMode": _RELATIVE,
            "hoverSpeed": plan.speed_m_s,
            "items": [_simple_item(number, item) for number, item in enumerate(plan.items, start=_HOME_ITEMS)],
            # The height of home above the sea is the vehicle's to find out: all heights count from home.
            "plannedHomePosition": [*_pair(plan.home), 0.0],
            "vehicleType": _MULTICOPTER,
            "version": 2,
        },
        "rallyPoints": {"points": [[*_pair(place), height_m] for place, height_m in plan.rally], "version": 2},
        "version": 1,
    }
    return (json.dumps(document, indent=4, sort_keys=True, allow_nan=False) + "\n").encode()


def waypoint_table(plan: AutopilotPlan) -> bytes:
    """The items as ``QGC WPL 110``, in which the first line is home; it has no fence and no rally points."""
    home = Item(Command.WAYPOINT, (0.0, 0.0, 0.0, 0.0), plan.home)
    rows = []
    for number, item in enumerate((home, *plan.items)):
        frame = Frame.ABOVE_SEA if number == 0 else _frame(item)
        # Not every reader of tables knows numbers that are none; to headings, 0 is the same on ArduPilot.
        params = [0.0 if math.isnan(value) else value for value in item.numbered(_HOME_ITEMS)]
        place = [0.0, 0.0] if item.place is None else _pair(item.place)
        numbers = [*(f"{value:.6f}" for value in params), *(f"{value:.9f}" for value in place), f"{item.height_m:.6f}"]
        rows.append(
            "\t".join([str(number), str(int(number == 0)), str(frame.value), str(item.command.value), *numbers, "1"])
        )
    return ("\n".join(["QGC WPL 110", *rows]) + "\n").encode()


def _simple_item(number: int, item: Item) -> dict[str, Any]:
    params = [None if math.isnan(value) else value for value in item.numbered(_HOME_ITEMS)]
    place = [0.0, 0.0] if item.place is None else _pair(item.place)
    height = {"AMSLAltAboveTerrain": None, "Altitude": item.height_m, "AltitudeMode": _RELATIVE}
    return {
        **(height if item.place else {}),
        "autoContinue": True,
        "command": item.command.value,
        "doJumpId": number,
        "frame": _frame(item).value,
        "params": [*params, *place, item.height_m],
        "type": "SimpleItem",
    }


def _frame(item: Item) -> Frame:
    return Frame.NO_PLACE if item.place is None else Frame.ABOVE_HOME


def _pair(place: LatLon) -> list[float]:
    """Latitude and longitude, to a tenth of a millimetre."""
    return [round(place.latitude_deg, _DIGITS), round(place.longitude_deg, _DIGITS)]
