"""Plans as QGroundControl writes them."""

import json
from typing import Any

from mission.interchange.features import Drawing, Lanes, Line, Polygon, Role, Spot
from mission.interchange.reading import read_drawing

SIMPLE = {"autoContinue": True, "doJumpId": 1, "frame": 3, "type": "SimpleItem", "AMSLAltAboveTerrain": None}
CAMERA = {
    "AdjustedFootprintFrontal": 25,
    "AdjustedFootprintSide": 18.5,
    "CameraName": "Manual (no camera specs)",
    "DistanceToSurface": 50,
    "DistanceMode": 1,
    "version": 2,
}


def plan(*items: dict[str, Any], **sections: Any) -> Drawing:  # noqa: ANN401 - any JSON value
    mission = {
        "cruiseSpeed": 15,
        "firmwareType": 12,
        "hoverSpeed": 5,
        "items": list(items),
        "plannedHomePosition": [38.7508, -77.4972, 30],
        "vehicleType": 2,
        "version": 2,
    }
    empty = {
        "geoFence": {"circles": [], "polygons": [], "version": 2},
        "rallyPoints": {"points": [], "version": 2},
    }
    whole = {"fileType": "Plan", "groundStation": "QGroundControl", "mission": mission, "version": 1, **empty}
    return read_drawing(json.dumps({**whole, **sections}).encode())


def test_fences_and_homes() -> None:
    corners = [[38.7507608, -77.4973590], [38.7509402, -77.4970928], [38.7507313, -77.4968650]]
    fence = {
        "circles": [{"circle": {"center": [38.7508, -77.4970], "radius": 12.5}, "inclusion": False, "version": 1}],
        "polygons": [
            {"inclusion": True, "polygon": corners, "version": 1},
            {"inclusion": False, "polygon": corners, "version": 1},
        ],
        "version": 2,
    }
    drawing = plan(geoFence=fence, rallyPoints={"points": [[38.7509, -77.4971, 50]], "version": 2})
    assert [(each.name, each.role, each.reason) for each in drawing.features] == [
        ("inclusion_polygon_1", Role.BOUNDARY, "an inclusion fence"),
        ("exclusion_polygon_2", Role.RESTRICTED, "an exclusion fence"),
        ("exclusion_circle_1", Role.RESTRICTED, "an exclusion fence"),
        ("home", Role.HOME, "the planned home"),
        ("rally_1", Role.HOME, "a rally point"),
    ]
    assert drawing.features[0].shapes == (
        Polygon(((-77.4973590, 38.7507608), (-77.4970928, 38.7509402), (-77.4968650, 38.7507313))),
    )
    assert [each.shapes[0] for each in drawing.features[2:]] == [
        Spot((-77.4970, 38.7508), 12.5),
        Spot((-77.4972, 38.7508)),
        Spot((-77.4971, 38.7509)),
    ]
    assert (drawing.speed_m_s, drawing.altitude_m) == (5.0, None)


def test_survey_and_corridor_items_are_regions_with_their_lanes() -> None:
    transects = {"CameraCalc": CAMERA, "Items": [], "VisualTransectPoints": [], "version": 2}
    survey = {
        "TransectStyleComplexItem": transects,
        "angle": 30,
        "complexItemType": "survey",
        "entryLocation": 0,
        "polygon": [[-37.751, 144.984], [-37.751, 144.994], [-37.755, 144.994]],
        "type": "ComplexItem",
        "version": 5,
    }
    corridor = {
        "CorridorWidth": 50,
        "EntryPoint": 0,
        "TransectStyleComplexItem": transects,
        "complexItemType": "CorridorScan",
        "polyline": [[-37.752, 144.989], [-37.754, 144.989]],
        "type": "ComplexItem",
        "version": 2,
    }
    landing = {"complexItemType": "fwLandingPattern", "landCoordinate": [-37.7, 144.9, 0], "type": "ComplexItem"}
    drawing = plan(survey, corridor, landing)
    (area, strip, _) = drawing.features
    assert (area.name, area.role, area.lanes) == ("survey_1", Role.SURVEY, Lanes(18.5, 30.0))
    assert (strip.name, strip.role, strip.shapes) == (
        "corridor_1",
        Role.SURVEY,
        (Line(((144.989, -37.752), (144.989, -37.754)), 50.0),),
    )
    assert drawing.altitude_m == 50.0
    assert drawing.remarks == ("mission.items[2] is left out: nothing is known of a fwLandingPattern",)


def test_waypoints_are_a_line_to_survey_along() -> None:
    drawing = plan(
        SIMPLE | {"command": 22, "params": [0, 0, 0, None, 47.1, 8.1, 30]},
        SIMPLE | {"command": 178, "params": [1, 7.5, -1, 0, 0, 0, 0]},
        SIMPLE | {"command": 16, "params": [0, 0, 0, None, 47.1, 8.1, 40]},
        SIMPLE | {"command": 16, "params": [0, 0, 0, None, 47.2, 8.1, 40]},
        SIMPLE | {"command": 20, "params": [0, 0, 0, 0, 0, 0, 0]},
    )
    route = drawing.features[0]
    assert (route.name, route.role, route.shapes) == ("route", Role.SURVEY, (Line(((8.1, 47.1), (8.1, 47.2))),))
    assert (drawing.altitude_m, drawing.speed_m_s) == (40.0, 7.5)
