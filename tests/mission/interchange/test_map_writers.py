"""Files for maps: sound by the rules of their formats, and read back here."""

import json
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import shapely
from shapely.geometry import shape

from mission.interchange.features import Polygon, Role
from mission.interchange.geojson_writer import geojson
from mission.interchange.gpx_writer import gpx
from mission.interchange.kml_writer import kml, kmz
from mission.interchange.map_features import MapFeature, continuous, within_the_map
from mission.interchange.reading import read_drawing

YARD = shapely.Polygon(
    [(8.0, 47.0), (8.0, 47.01), (8.02, 47.01), (8.02, 47.0)],
    [[(8.005, 47.002), (8.01, 47.002), (8.01, 47.006)]],
)
LINE = shapely.LineString([(8.001, 47.001), (8.003, 47.001), (8.003, 47.0015)])
FEATURES = [
    MapFeature("yard <&> \x00wall", "restricted", "Regions", YARD, "#D55E00", height_m=20.0),
    MapFeature(
        "fields",
        "survey",
        "Regions",
        shapely.MultiPolygon([shapely.box(8.03, 47.0, 8.04, 47.01), shapely.box(8.05, 47.0, 8.06, 47.01)]),
        "#56B4E9",
        properties={"loiter_s": 5.0},
    ),
    MapFeature("T0", "triangle", "Triangles", shapely.Polygon([(8, 47), (8.1, 47), (8, 47.1)]), "#BDBDBD"),
    MapFeature("path", "path", "Flight", LINE, "#0072B2", height_m=20.0, properties={"run": [0, 3, 1]}),
    MapFeature("5 s", "stop", "Flight", shapely.Point(8.003, 47.001), "#000000", height_m=20.0),
]
K, G = "{http://www.opengis.net/kml/2.2}", "{http://www.topografix.com/GPX/1/1}"


def of_geojson() -> list[dict[str, Any]]:
    document = json.loads(geojson("farm", FEATURES))
    assert (document["type"], document["name"]) == ("FeatureCollection", "farm")
    features: list[dict[str, Any]] = document["features"]
    return features


def test_geojson_has_each_feature_with_its_properties_and_colour() -> None:
    yard, fields, _, path, stop = of_geojson()
    assert shape(yard["geometry"]).equals(YARD)
    assert (yard["properties"]["kind"], yard["properties"]["fill"]) == ("restricted", "#D55E00")
    assert fields["geometry"]["type"] == "MultiPolygon"
    assert fields["properties"]["loiter_s"] == 5.0
    assert path["geometry"]["coordinates"] == [[8.001, 47.001], [8.003, 47.001], [8.003, 47.0015]]
    assert (path["properties"]["run"], path["properties"]["height_m"]) == ([0, 3, 1], 20.0)
    assert stop["properties"]["marker-color"] == "#000000"
    assert "height_m" not in yard["properties"]


def test_outlines_of_geojson_are_counter_clockwise_and_holes_clockwise() -> None:
    outline, hole = of_geojson()[0]["geometry"]["coordinates"]
    assert shapely.is_ccw(shapely.linearrings(outline))
    assert not shapely.is_ccw(shapely.linearrings(hole))
    assert outline[0] == outline[-1]


@pytest.mark.parametrize("content", [geojson("farm", FEATURES), kml("farm", FEATURES), kmz("farm", FEATURES)])
def test_areas_are_read_back_and_what_is_of_the_flight_is_not(content: bytes) -> None:
    drawing = read_drawing(content)
    yard, fields = drawing.features
    assert (yard.role, fields.role) == (Role.RESTRICTED, Role.SURVEY)
    (outline,) = yard.shapes
    assert isinstance(outline, Polygon)
    assert shapely.Polygon(outline.outline, outline.holes).equals(YARD)
    assert len(fields.shapes) == 2
    assert drawing.remarks == ("3 features of a flight are left out: its path, its stops, its triangles",)


def placemarks() -> dict[str, ET.Element]:
    root = ET.fromstring(kml("farm", FEATURES))  # noqa: S314 - written here
    return {mark.findtext(f"{K}name", ""): mark for mark in root.iter(f"{K}Placemark")}


def test_the_path_of_kml_is_a_curtain_above_the_ground() -> None:
    line = placemarks()["path"].find(f"{K}LineString")
    assert line is not None
    assert [child.tag.removeprefix(K) for child in line] == ["extrude", "altitudeMode", "coordinates"]
    assert (line.findtext(f"{K}extrude"), line.findtext(f"{K}altitudeMode")) == ("1", "relativeToGround")
    corners = [tuple(map(float, place.split(","))) for place in line.findtext(f"{K}coordinates", "").split()]
    assert corners == [(8.001, 47.001, 20.0), (8.003, 47.001, 20.0), (8.003, 47.0015, 20.0)]


def test_areas_of_kml_lie_on_the_ground_but_for_walls() -> None:
    marks = placemarks()
    wall = marks["yard <&> ?wall"].find(f"{K}Polygon")
    assert wall is not None
    assert wall.findtext(f"{K}altitudeMode") == "relativeToGround"
    assert [child.tag.removeprefix(K) for child in wall][2:] == ["outerBoundaryIs", "innerBoundaryIs"]
    fields = marks["fields"].findall(f"{K}MultiGeometry/{K}Polygon")
    assert [field.findtext(f"{K}altitudeMode") for field in fields] == ["clampToGround"] * 2


def test_colours_of_kml_are_those_of_the_pictures_from_blue_to_red() -> None:
    root = ET.fromstring(kml("farm", FEATURES))  # noqa: S314 - written here
    style = next(each for each in root.iter(f"{K}Style") if each.get("id") == "restricted")
    assert style.findtext(f"{K}LineStyle/{K}color") == "ff005ed5"
    assert placemarks()["yard <&> ?wall"].findtext(f"{K}styleUrl") == "#restricted"


def test_a_kmz_is_the_same_bytes_each_time() -> None:
    assert kmz("farm", FEATURES) == kmz("farm", FEATURES)


def test_gpx_has_the_path_as_track_and_places_as_waypoints() -> None:
    root = ET.fromstring(gpx("farm", FEATURES))  # noqa: S314 - written here
    assert (root.tag, root.get("version")) == (f"{G}gpx", "1.1")
    assert [child.tag.removeprefix(G) for child in root] == ["metadata", "wpt", "trk"]
    points = root.findall(f"{G}trk/{G}trkseg/{G}trkpt")
    assert [(float(p.get("lon", "")), float(p.get("lat", ""))) for p in points] == list(LINE.coords)
    assert root.findtext(f"{G}trk/{G}desc") == "20 m above the take-off, run: 0 3 1"
    # Elevations would count from the sea.
    assert root.find(f".//{G}ele") is None


def test_what_crosses_the_antimeridian_is_cut_there() -> None:
    ring = continuous(np.array([(179.99, -17.0), (-179.98, -17.0), (-179.98, -16.9), (179.99, -16.9)]))
    parts = shapely.get_parts(within_the_map(shapely.Polygon(ring)))
    assert sorted(part.bounds for part in parts) == [
        pytest.approx((-180.0, -17.0, -179.98, -16.9)),
        pytest.approx((179.99, -17.0, 180.0, -16.9)),
    ]
    line = within_the_map(shapely.LineString(continuous(np.array([(-179.9, 0.0), (179.9, 0.2), (-179.9, 0.4)]))))
    assert len(shapely.get_parts(line)) == 3
    assert (abs(shapely.get_coordinates(line)[:, 0]) <= 180.0).all()
    # Read again, it is one area: no edge is left where it was cut.
    (sea,) = read_drawing(geojson("", [MapFeature("sea", "survey", "", shapely.Polygon(ring), "#000000")])).features
    (whole,) = sea.shapes
    assert isinstance(whole, Polygon)
    back = shapely.Polygon(continuous(np.array(whole.outline)))
    assert back.area == pytest.approx(0.03 * 0.1)
    assert set(ring[:, 0].round(6)) <= set(shapely.get_coordinates(back)[:, 0].round(6))
