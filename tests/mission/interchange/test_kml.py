"""KML and KMZ as Google Earth and QGIS write them."""

import zipfile
from io import BytesIO

import pytest

from mission.interchange.features import Line, Polygon, Role, Spot
from mission.interchange.reading import read_drawing

GOOGLE_EARTH = """\
<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2">
<Document>
	<name>Farm.kmz</name>
	<StyleMap id="msn_ylw-pushpin">
		<Pair><key>normal</key><styleUrl>#sn_ylw-pushpin</styleUrl></Pair>
		<Pair><key>highlight</key><styleUrl>#sh_ylw-pushpin</styleUrl></Pair>
	</StyleMap>
	<Style id="sn_ylw-pushpin">
		<LineStyle><color>ff0000ff</color></LineStyle>
		<PolyStyle><color>7f0000ff</color></PolyStyle>
	</Style>
	<Style id="sh_ylw-pushpin"><PolyStyle><color>7f00ff00</color></PolyStyle></Style>
	<Folder>
		<name>Fields</name>
		<Placemark>
			<name>North &amp; west</name>
			<Polygon>
				<tessellate>1</tessellate>
				<outerBoundaryIs><LinearRing><coordinates>
					6.54,51.89,0 6.541,51.89,0 6.541,51.891,0 6.54,51.891,0 6.54,51.89,0
				</coordinates></LinearRing></outerBoundaryIs>
				<innerBoundaryIs><LinearRing><coordinates>
					6.5402,51.8902,0 6.5404,51.8902,0 6.5404,51.8904,0 6.5402,51.8902,0
				</coordinates></LinearRing></innerBoundaryIs>
			</Polygon>
		</Placemark>
	</Folder>
	<Placemark>
		<name>Untitled Polygon</name>
		<styleUrl>#msn_ylw-pushpin</styleUrl>
		<Polygon><extrude>1</extrude><altitudeMode>relativeToGround</altitudeMode>
			<outerBoundaryIs><LinearRing><coordinates>
				6.5401,51.8901,12.5 6.5402,51.8901,12.5 6.5402,51.8902,12.5 6.5401,51.8901,12.5
			</coordinates></LinearRing></outerBoundaryIs>
		</Polygon>
	</Placemark>
	<Placemark>
		<name>Untitled Path</name>
		<LineString><tessellate>1</tessellate><coordinates>6.54,51.89,0 6.541,51.892,0 </coordinates></LineString>
	</Placemark>
	<Placemark><name>Launch</name><Point><gx:drawOrder>1</gx:drawOrder><coordinates>6.5405,51.8895,0</coordinates></Point></Placemark>
</Document>
</kml>
"""

QGIS = """\
<?xml version="1.0" encoding="utf-8" ?>
<kml xmlns="http://www.opengis.net/kml/2.2">
<Document id="root_doc">
<Schema name="houses" id="houses"><SimpleField name="height" type="float"></SimpleField></Schema>
<Folder><name>houses</name>
  <Placemark>
	<Style><LineStyle><color>ff0000ff</color></LineStyle><PolyStyle><fill>0</fill></PolyStyle></Style>
	<ExtendedData><SchemaData schemaUrl="#houses">
		<SimpleData name="Name">No. 3</SimpleData>
		<SimpleData name="height">7.5</SimpleData>
	</SchemaData></ExtendedData>
      <MultiGeometry><Polygon><outerBoundaryIs><LinearRing><coordinates>1,1 1.001,1 1.001,1.001 1,1</coordinates>\
</LinearRing></outerBoundaryIs></Polygon><Polygon><outerBoundaryIs><LinearRing><coordinates>1.002,1 1.003,1 \
1.003,1.001 1.002,1</coordinates></LinearRing></outerBoundaryIs></Polygon></MultiGeometry>
  </Placemark>
</Folder>
</Document></kml>
"""


def archive(files: dict[str, str]) -> bytes:
    content = BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as written:
        for name, text in files.items():
            written.writestr(name, text)
    return content.getvalue()


def test_as_google_earth_writes_it() -> None:
    fields, red, path, launch = read_drawing(GOOGLE_EARTH.encode()).features
    assert (fields.name, fields.role, fields.reason) == ("North & west", Role.SURVEY, "told by its folder")
    assert fields.shapes == (
        Polygon(
            ((6.54, 51.89), (6.541, 51.89), (6.541, 51.891), (6.54, 51.891)),
            (((6.5402, 51.8902), (6.5404, 51.8902), (6.5404, 51.8904)),),
        ),
    )
    assert fields.height_m is None
    assert (red.role, red.reason, red.height_m) == (Role.RESTRICTED, "told by its red fill", 12.5)
    assert (path.role, path.shapes) == (None, (Line(((6.54, 51.89), (6.541, 51.892))),))
    assert (launch.role, launch.shapes) == (Role.HOME, (Spot((6.5405, 51.8895)),))


def test_as_qgis_writes_it() -> None:
    (house,) = read_drawing(QGIS.encode()).features
    assert (house.name, house.height_m, len(house.shapes)) == ("No. 3", 7.5, 2)
    assert (house.role, house.reason) == (Role.RESTRICTED, "told by its folder")


def test_tracks_data_and_prefixes() -> None:
    text = """\
<kml:kml xmlns:kml="http://earth.google.com/kml/2.1"><kml:Placemark>
  <kml:ExtendedData><kml:Data name="kind"><kml:value>boundary</kml:value></kml:Data>
  <kml:Data name="width"><kml:value>8</kml:value></kml:Data></kml:ExtendedData>
  <gx:Track><when>2013-07-25T19:33:59.000Z</when><gx:coord>7 51 40</gx:coord><gx:coord>7.001 51 40</gx:coord></gx:Track>
</kml:Placemark></kml:kml>"""
    (track,) = read_drawing(text.encode()).features
    assert track.shapes == (Line(((7.0, 51.0), (7.001, 51.0)), 8.0),)
    assert (track.name, track.role, track.reason) == ("", Role.BOUNDARY, "told by its property kind")


def test_white_space_behind_commas_and_other_encodings() -> None:
    text = '<?xml version="1.0" encoding="ISO-8859-1"?><kml><Placemark><name>Äcker</name><LineString><coordinates>'
    text += "7, 51, 0\n7.001, 51, 0</coordinates></LineString></Placemark></kml>"
    (path,) = read_drawing(text.encode("latin-1")).features
    assert (path.name, path.shapes) == ("Äcker", (Line(((7.0, 51.0), (7.001, 51.0))),))


def test_links_are_told_of_and_not_followed() -> None:
    link = "<NetworkLink><name>All parcels</name><Link><href>http://example.org/all.kml</href></Link></NetworkLink>"
    drawing = read_drawing(GOOGLE_EARTH.replace("<Folder>", f"{link}<Folder>").encode())
    assert drawing.remarks == ("the NetworkLink 'All parcels' has no shape here; links are not followed",)


@pytest.mark.parametrize("names", [("doc.kml", "files/other.kml"), ("Farm.KML",), ("a.txt", "doc.kml")])
def test_the_main_text_of_an_archive_is_read(names: tuple[str, ...]) -> None:
    files = {name: QGIS if "other" in name or name.endswith("txt") else GOOGLE_EARTH for name in names}
    drawing = read_drawing(archive(files))
    assert drawing.format == "KMZ"
    assert len(drawing.features) == 4


def test_of_several_texts_in_an_archive_one_is_read_and_the_others_are_named() -> None:
    content = BytesIO()
    with zipfile.ZipFile(content, "w") as written:
        written.writestr("__MACOSX/._Doc.KML", b"\0\5\x16")
        written.writestr("first.kml", "<kml/>")
        written.writestr("Doc.KML", GOOGLE_EARTH)
    drawing = read_drawing(content.getvalue())
    assert drawing.features == read_drawing(GOOGLE_EARTH.encode()).features
    assert drawing.remarks[0] == "first.kml in the archive is left out, Doc.KML is read"
