"""Plans as QGroundControl writes them."""

import json
from typing import Any

from mission.interchange.features import Camera, Drawing, Lanes, Line, Polygon, Role, Spot
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


def test_waypoints_are_a_route_and_no_region() -> None:
    drawing = plan(
        SIMPLE | {"command": 22, "params": [0, 0, 0, None, 47.1, 8.1, 30]},
        SIMPLE | {"command": 178, "params": [1, 7.5, -1, 0, 0, 0, 0]},
        SIMPLE | {"command": 16, "params": [0, 0, 0, None, 47.1, 8.1, 40]},
        SIMPLE | {"command": 16, "params": [0, 0, 0, None, 47.2, 8.1, 40]},
        SIMPLE | {"command": 19, "params": [10, 0, 0, 0, 0, 0, 0]},  # wherever the vehicle is
        SIMPLE | {"command": 20, "params": [0, 0, 0, 0, 0, 0, 0]},
    )
    assert [each.name for each in drawing.features] == ["home"]
    assert drawing.route == ((8.1, 47.1), (8.1, 47.2))
    assert (drawing.altitude_m, drawing.speed_m_s) == (40.0, 7.5)


def test_the_camera_of_a_survey_is_kept_as_it_is_held() -> None:
    camera = CAMERA | {
        "CameraName": "Sony",
        "SensorWidth": 13.2,
        "SensorHeight": 8.8,
        "FocalLength": 10.0,
        "FrontalOverlap": 75,
        "SideOverlap": 70,
    }
    survey = {
        "angle": 30,
        "complexItemType": "survey",
        "polygon": [[-37.751, 144.984], [-37.751, 144.994], [-37.755, 144.994]],
        "type": "ComplexItem",
        "version": 5,
    }
    for landscape, sensor_mm in ((True, (13.2, 8.8)), (False, (8.8, 13.2))):
        transects = {"CameraCalc": camera | {"Landscape": landscape}, "version": 1}
        (area, _) = plan(survey | {"TransectStyleComplexItem": transects}).features
        assert area.lanes == Lanes(18.5, 30.0, Camera(None, sensor_mm, 10.0, 0.75, 0.7))


def test_plans_of_the_first_version_have_grids_places_apart_and_one_fence() -> None:
    # As QGroundControl 3.2 wrote them: SurveyMissionItem.cc, SimpleMissionItem.cc and GeoFenceManager.cc of that time.
    survey = {
        "camera": {
            "focalLength": 16,
            "imageFrontalOverlap": 10,
            "imageSideOverlap": 20,
            "name": "Sony",
            "orientationLandscape": True,
            "sensorHeight": 15.4,
            "sensorWidth": 23.2,
        },
        "complexItemType": "survey",
        "grid": {"altitude": 50, "angle": 15, "relativeAltitude": True, "spacing": 58, "turnAroundDistance": 0},
        "polygon": [[47.1, 8.1], [47.1, 8.11], [47.11, 8.11]],
        "type": "ComplexItem",
        "version": 3,
    }
    waypoint = {"command": 16, "coordinate": [47.2, 8.2, 30], "frame": 3, "params": [0, 0, 0, 0], "type": "SimpleItem"}
    older = {"command": 16, "coordinate": [47.3, 8.2, 35], "type": "missionItem", "param1": 0, "param2": 0}
    fence = {"polygon": [[47, 8], [47, 8.4], [47.4, 8.4]], "version": 1}
    home = {"coordinate": [47.05, 8.05, 0], "type": "missionItem"}
    mission = {"items": [survey, waypoint, older], "plannedHomePosition": home, "version": 1}
    drawing = plan(mission=mission, geoFence=fence, rallyPoints={"points": []})
    assert [(each.name, each.role) for each in drawing.features] == [
        ("inclusion_polygon_1", Role.BOUNDARY),
        ("survey_1", Role.SURVEY),
        ("home", Role.HOME),
    ]
    assert drawing.features[2].shapes == (Spot((8.05, 47.05)),)
    assert drawing.features[1].lanes == Lanes(58.0, 15.0, Camera(None, (23.2, 15.4), 16.0, 0.1, 0.2))
    assert (drawing.route, drawing.altitude_m) == (((8.2, 47.2), (8.2, 47.3)), 50.0)
