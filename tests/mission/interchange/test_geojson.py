"""GeoJSON as geojson.io, QGIS and others write it."""

import json
from typing import Any

import pytest

from mission.errors import SpecError
from mission.interchange.features import Drawing, Line, Polygon, Role, Spot
from mission.interchange.reading import read_drawing

SQUARE = [[7.0, 51.0], [7.001, 51.0], [7.001, 51.001], [7.0, 51.001], [7.0, 51.0]]
POND = [[7.0002, 51.0002], [7.0002, 51.0004], [7.0004, 51.0004], [7.0002, 51.0002]]


def read(value: object, *, in_metres: bool | None = None) -> Drawing:
    return read_drawing(json.dumps(value).encode(), in_metres=in_metres)


def feature(geometry: dict[str, Any] | None, **properties: object) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def collection(*features: dict[str, Any], **more: object) -> dict[str, Any]:
    return {"type": "FeatureCollection", **more, "features": list(features)}


def test_a_polygon_with_a_hole_is_read_without_its_closing_corner() -> None:
    (field,) = read(collection(feature({"type": "Polygon", "coordinates": [SQUARE, POND]}, name="North"))).features
    assert field.name == "North"
    assert field.shapes == (
        Polygon(
            ((7.0, 51.0), (7.001, 51.0), (7.001, 51.001), (7.0, 51.001)),
            (((7.0002, 51.0002), (7.0002, 51.0004), (7.0004, 51.0004)),),
        ),
    )


def test_geometries_of_several_parts_are_one_feature() -> None:
    rows = {"type": "MultiPolygon", "coordinates": [[SQUARE], [POND]]}
    mixed = {"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [7, 51, 80.5]}, rows]}
    drawing = read(collection(feature(rows), feature(mixed)))
    assert [[type(shape) for shape in each.shapes] for each in drawing.features] == [
        [Polygon, Polygon],
        [Spot, Polygon, Polygon],
    ]


def test_a_line_and_a_point_take_width_and_radius_from_their_properties() -> None:
    drawing = read(
        collection(
            feature({"type": "LineString", "coordinates": [[7, 51], [7.001, 51]]}, width_m=8),
            feature({"type": "Point", "coordinates": [7, 51]}, radius="12.5", height=30),
        )
    )
    assert [each.shapes[0] for each in drawing.features] == [
        Line(((7.0, 51.0), (7.001, 51.0)), 8.0),
        Spot((7.0, 51.0), 12.5),
    ]
    assert [each.height_m for each in drawing.features] == [None, 30.0]


def test_a_line_that_comes_back_is_the_outline_that_it_draws() -> None:
    (outline,) = read({"type": "LineString", "coordinates": SQUARE}).features
    assert outline.shapes == (Polygon(((7.0, 51.0), (7.001, 51.0), (7.001, 51.001), (7.0, 51.001))),)


def test_as_qgis_writes_it() -> None:
    # A layer with a name, a reference system by its old member, and attributes in capital letters.
    system = {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}
    parcels = collection(
        {"type": "Feature", "properties": {"fid": 7, "Name": None, "landuse": "meadow"}, "geometry": None},
        feature({"type": "MultiPolygon", "coordinates": [[SQUARE]]}, fid=8, landuse="meadow", area=None),
        name="parcels_2024",
        crs=system,
    )
    drawing = read(parcels)
    (meadow,) = drawing.features
    assert (meadow.name, meadow.role, meadow.reason) == ("8", Role.SURVEY, "told by its property landuse")
    assert drawing.remarks == ("features[0] has no geometry",)


def test_as_geojson_io_writes_it() -> None:
    simplestyle = {"stroke": "#555555", "stroke-width": 2, "fill": "#ff0000", "fill-opacity": 0.5}
    geometry = {"coordinates": [SQUARE], "type": "Polygon"}
    (red, plain) = read(
        collection({"id": 0, **feature(geometry, **simplestyle)}, {"id": 1, **feature(geometry)})
    ).features
    assert (red.role, red.reason) == (Role.RESTRICTED, "told by its red fill")
    assert (plain.role, plain.reason) == (None, "")


@pytest.mark.parametrize(
    ("properties", "role"),
    [
        ({"kind": "survey"}, Role.SURVEY),
        ({"name": "Farmhouse"}, Role.RESTRICTED),
        ({"name": "NoFlyZone 3"}, Role.RESTRICTED),
        ({"name": "power_line"}, Role.RESTRICTED),
        ({"name": "exclusion fence"}, Role.RESTRICTED),
        ({"building": "yes", "name": "Nr. 5"}, Role.RESTRICTED),
        ({"building": "no", "name": "Nr. 5"}, None),
        ({"natural": "water"}, Role.RESTRICTED),
        ({"inclusion": False}, Role.RESTRICTED),
        ({"inclusion": True}, Role.BOUNDARY),
        ({"name": "Geofence"}, Role.BOUNDARY),
        ({"name": "Take-off"}, Role.HOME),
        ({"name": "Survey area"}, Role.SURVEY),
        ({"kind": "area", "name": "orchard"}, Role.AREA),
        ({"name": "North field", "kind": "restricted"}, Role.RESTRICTED),
        ({"name": "Landhouse Lane 3"}, None),
        ({"name": "Untitled"}, None),
    ],
)
def test_roles_are_told_by_properties_first_and_then_by_the_name(
    properties: dict[str, object], role: Role | None
) -> None:
    (read_back,) = read(collection(feature({"type": "Polygon", "coordinates": [SQUARE]}, **properties))).features
    assert read_back.role is role


def test_metres_are_told_from_degrees() -> None:
    ring = [[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0], [0, 0, 0]]
    assert not read({"type": "Polygon", "coordinates": [ring]}).in_degrees
    projected = [[x + 389_000.25, y + 5_751_000.5] for x, y, _ in ring]
    drawing = read({"type": "Polygon", "coordinates": [projected]})
    assert not drawing.in_degrees
    assert drawing.points()[0] == (389_000.25, 5_751_000.5)
    assert read({"type": "Polygon", "coordinates": [SQUARE]}).in_degrees
    assert not read({"type": "Polygon", "coordinates": [SQUARE]}, in_metres=True).in_degrees


def test_a_projected_system_is_refused_unless_its_metres_are_wanted() -> None:
    system = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32632"}}
    utm = {"type": "Polygon", "coordinates": [[[389_000, 5_751_000], [389_100, 5_751_000], [389_000, 5_751_100]]]}
    with pytest.raises(SpecError) as refused:
        read(collection(feature(utm), crs=system))
    (fault,) = refused.value.faults
    assert fault.path == "crs.properties.name"
    assert fault.message == "the coordinates are in urn:ogc:def:crs:EPSG::32632, not in WGS 84"
    assert not read(collection(feature(utm), crs=system), in_metres=True).in_degrees


def test_longitudes_that_go_on_beyond_the_antimeridian_are_degrees() -> None:
    corners = [[179.999, -17], [180.001, -17], [180.001, -16.999], [179.999, -16.999]]
    drawing = read_drawing(json.dumps({"type": "Polygon", "coordinates": [corners]}).encode())
    assert drawing.in_degrees
    (outline,) = drawing.features[0].shapes
    assert isinstance(outline, Polygon)
    assert [round(x, 9) for x, _ in outline.outline] == [179.999, -179.999, -179.999, 179.999]


def test_degrees_the_other_way_round_are_told_as_that() -> None:
    corners = [[37.7, -122.4], [37.701, -122.4], [37.701, -122.401]]
    with pytest.raises(SpecError) as refused:
        read_drawing(json.dumps({"type": "Polygon", "coordinates": [corners]}).encode())
    (fault,) = refused.value.faults
    assert fault.message == "longitude 37.7, latitude -122.4 is no place on Earth"
    assert fault.hint.endswith("the longitude first in GeoJSON and KML: they are the other way round here")
