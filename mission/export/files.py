"""The kinds of files that a plan is exported to, by the ending of their names."""

from collections.abc import Callable, Mapping
from typing import Final

from mission.export.drawings import areas, flight, triangles
from mission.export.placed_plan import PlacedPlan
from mission.export.uploads import autopilot_plan
from mission.interchange.autopilot_plan_writers import qgroundcontrol_plan, waypoint_table
from mission.interchange.geojson_writer import geojson
from mission.interchange.gpx_writer import gpx
from mission.interchange.kml_writer import kml, kmz

Writer = Callable[[PlacedPlan, str, str], bytes]
"""From a plan, its name and the autopilot that it is for to the content of a file."""

WRITERS: Final[Mapping[str, Writer]] = {
    ".plan": lambda placed, _, firmware: qgroundcontrol_plan(autopilot_plan(placed, firmware), firmware=firmware),
    ".waypoints": lambda placed, _, firmware: waypoint_table(autopilot_plan(placed, firmware)),
    ".geojson": lambda placed, name, _: geojson(name, [*areas(placed), *triangles(placed), *flight(placed)]),
    ".kml": lambda placed, name, _: kml(name, [*areas(placed), *flight(placed)]),
    ".kmz": lambda placed, name, _: kmz(name, [*areas(placed), *flight(placed)]),
    ".gpx": lambda placed, name, _: gpx(name, list(flight(placed))),
}
"""By ending, in lower case."""

FENCED: Final = ".plan"
UPLOADED: Final = frozenset({FENCED, ".waypoints"})
"""What autopilots fly, and of that what has a fence; all else is for looking at."""
