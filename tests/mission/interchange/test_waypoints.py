"""Waypoint and fence files as Mission Planner and MAVProxy write them."""

from mission.interchange.features import Polygon, Role, Spot
from mission.interchange.reading import read_drawing

MISSION_PLANNER = (
    "QGC WPL 110\r\n"
    "0\t1\t0\t16\t0\t0\t0\t0\t-35.363262\t149.165237\t584.090000\t1\r\n"
    "1\t0\t3\t22\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t25.000000\t1\r\n"
    "2\t0\t3\t178\t1.0\t6.5\t0.0\t0.0\t0.0\t0.0\t0.0\t1\r\n"
    "3\t0\t3\t16\t0.0\t0.0\t0.0\t0.0\t-35.36200000\t149.16400000\t40.000000\t1\r\n"
    "4\t0\t3\t16\t0.0\t0.0\t0.0\t0.0\t-35.36200000\t149.16600000\t40.000000\t1\r\n"
    "5\t0\t3\t20\t0.0\t0.0\t0.0\t0.0\t0.00000000\t0.00000000\t0.000000\t1\r\n"
)

MAVPROXY_FENCE = (
    "QGC WPL 110\n"
    "0\t1\t0\t5001\t3.000000\t0\t0\t0\t-35.36100000\t149.16300000\t0.000000\t0\n"
    "1\t0\t0\t5001\t3.000000\t0\t0\t0\t-35.36100000\t149.16700000\t0.000000\t0\n"
    "2\t0\t0\t5001\t3.000000\t0\t0\t0\t-35.36500000\t149.16500000\t0.000000\t0\n"
    "3\t0\t0\t5002\t3.000000\t0\t0\t0\t-35.36200000\t149.16450000\t0.000000\t0\n"
    "4\t0\t0\t5002\t3.000000\t0\t0\t0\t-35.36200000\t149.16500000\t0.000000\t0\n"
    "5\t0\t0\t5002\t3.000000\t0\t0\t0\t-35.36250000\t149.16500000\t0.000000\t0\n"
    "6\t0\t0\t5004\t20.000000\t0\t0\t0\t-35.36300000\t149.16500000\t0.000000\t0\n"
    "7\t0\t0\t5000\t0.000000\t0\t0\t0\t-35.36150000\t149.16500000\t0.000000\t0\n"
)

OLD_FENCE = """\
-35.363720 149.163651
-35.358738 149.165070
-35.359295 149.154434
-35.372292 149.157135
-35.368290 149.166809
-35.358738 149.165070
"""


def test_a_mission_is_its_home_and_a_route() -> None:
    drawing = read_drawing(MISSION_PLANNER.encode())
    (home,) = drawing.features
    assert (home.name, home.role, home.shapes) == ("home", Role.HOME, (Spot((149.165237, -35.363262)),))
    assert drawing.route == ((149.164, -35.362), (149.166, -35.362))
    assert (drawing.altitude_m, drawing.speed_m_s) == (40.0, 6.5)


def test_a_first_line_above_the_start_is_a_waypoint_and_no_home() -> None:
    text = MISSION_PLANNER.replace("0\t1\t0\t16", "0\t1\t3\t16")
    drawing = read_drawing(text.encode())
    assert drawing.features == ()
    assert drawing.route == ((149.165237, -35.363262), (149.164, -35.362), (149.166, -35.362))


def test_a_fence_is_boundary_restricted_areas_and_a_return_point() -> None:
    features = read_drawing(MAVPROXY_FENCE.encode()).features
    assert [(each.name, each.role) for each in features] == [
        ("inclusion_polygon_1", Role.BOUNDARY),
        ("exclusion_polygon_2", Role.RESTRICTED),
        ("exclusion_circle_3", Role.RESTRICTED),
        ("return_point", Role.HOME),
    ]
    assert features[0].shapes == (Polygon(((149.163, -35.361), (149.167, -35.361), (149.165, -35.365))),)
    assert features[2].shapes == (Spot((149.165, -35.363), 20.0),)


def test_a_fence_about_a_home_that_is_not_in_the_file_is_left_out_and_said_so() -> None:
    text = MAVPROXY_FENCE + "8\t0\t0\t5005\t50.0\t0.0\t0.0\t0.0\t0.0\t0.0\t0.0\t0\n"
    drawing = read_drawing(text.encode())
    assert len(drawing.features) == 4
    assert drawing.remarks == ("line 10 is left out: nothing is known of a fence by command 5005",)


def test_an_older_fence_returns_to_its_first_point_and_is_closed_by_its_last() -> None:
    fence, home = read_drawing(OLD_FENCE.encode()).features
    assert (fence.role, fence.shapes) == (
        Role.BOUNDARY,
        (
            Polygon(
                ((149.165070, -35.358738), (149.154434, -35.359295), (149.157135, -35.372292), (149.166809, -35.368290))
            ),
        ),
    )
    assert (home.role, home.shapes) == (Role.HOME, (Spot((149.163651, -35.363720)),))


def test_rally_points() -> None:
    text = "RALLY\t-35.36\t149.16\t100.0\t50.0\t0.0\t0\nRALLY\t-35.37\t149.17\t100.0\t50.0\t0.0\t0\n"
    features = read_drawing(text.encode()).features
    assert [each.shapes[0] for each in features] == [Spot((149.16, -35.36)), Spot((149.17, -35.37))]
