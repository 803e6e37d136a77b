"""Offsets on the ellipsoid against Vincenty's inverse formula and degree lengths, which share nothing with the code."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import GeometryError
from mission.geometry.geodesy import LatLon, enu_offset_m, place_at_offset
from tests.support.drawn_cases import tried

A, F = 6_378_137.0, 1.0 / 298.257223563
B = A * (1.0 - F)

latitudes = st.floats(-85.0, 85.0)
longitudes = st.floats(-179.0, 179.0)
steps = st.floats(-60_000.0, 60_000.0)


def vincenty(p: LatLon, q: LatLon) -> tuple[float, float]:
    """Geodesic distance and azimuth at p (Vincenty, Survey Review 1975), iterated to the end."""
    u1, u2 = (math.atan((1 - F) * math.tan(math.radians(x.latitude_deg))) for x in (p, q))
    target = math.radians(q.longitude_deg - p.longitude_deg)
    turned = target
    for _ in range(100):
        t1 = math.cos(u2) * math.sin(turned)
        t2 = math.cos(u1) * math.sin(u2) - math.sin(u1) * math.cos(u2) * math.cos(turned)
        sin_s = math.hypot(t1, t2)
        cos_s = math.sin(u1) * math.sin(u2) + math.cos(u1) * math.cos(u2) * math.cos(turned)
        s = math.atan2(sin_s, cos_s)
        sin_a = math.cos(u1) * math.cos(u2) * math.sin(turned) / sin_s
        cos2_a = 1 - sin_a**2
        cos_2m = cos_s - 2 * math.sin(u1) * math.sin(u2) / cos2_a if cos2_a > 1e-15 else 0.0
        c = F / 16 * cos2_a * (4 + F * (4 - 3 * cos2_a))
        before = turned
        turned = target + (1 - c) * F * sin_a * (s + c * sin_s * (cos_2m + c * cos_s * (2 * cos_2m**2 - 1)))
        if abs(turned - before) < 1e-15:
            break
    k = cos2_a * (A * A - B * B) / (B * B)
    big_a = 1 + k / 16384 * (4096 + k * (-768 + k * (320 - 175 * k)))
    big_b = k / 1024 * (256 + k * (-128 + k * (74 - 47 * k)))
    inner = cos_s * (2 * cos_2m**2 - 1) - big_b / 6 * cos_2m * (4 * sin_s**2 - 3) * (4 * cos_2m**2 - 3)
    return B * big_a * (s - big_b * sin_s * (cos_2m + big_b / 4 * inner)), math.atan2(t1, t2)


@given(latitudes, longitudes, steps, steps)
@tried(200)
def test_offset_and_place_invert_each_other(latitude: float, longitude: float, east: float, north: float) -> None:
    start = LatLon(latitude, longitude)
    found = enu_offset_m(start, place_at_offset(start, east, north))
    assert found == pytest.approx((east, north), abs=1e-8)


@given(latitudes, longitudes, st.floats(10.0, 60_000.0), st.floats(-math.pi, math.pi))
@tried(200)
def test_offset_agrees_with_the_geodesic(latitude: float, longitude: float, length: float, bearing: float) -> None:
    start = LatLon(latitude, longitude)
    end = place_at_offset(start, length * math.sin(bearing), length * math.cos(bearing))
    distance, azimuth = vincenty(start, end)
    # The plane shortens the arc s to R sin(s / R); R lies between 6335 and 6400 km whatever the azimuth.
    assert distance >= length - 1e-4
    assert distance - length <= distance**3 / (6 * 6.335e6**2) * 1.001 + 1e-4
    assert abs(math.remainder(azimuth - bearing, 2 * math.pi)) * length < 1e-3 + length**3 / 6.3e6**2


@pytest.mark.parametrize(
    ("latitude", "north_m_deg", "east_m_deg"),
    # Lengths of a degree of latitude and of longitude on WGS 84, as tabulated (metres).
    [(0.0, 110_574.3, 111_319.5), (45.0, 111_131.8, 78_846.8), (60.0, 111_412.3, 55_800.3)],
)
def test_small_steps_match_the_tabulated_degrees(latitude: float, north_m_deg: float, east_m_deg: float) -> None:
    start = LatLon(latitude, 8.5)
    east, north = enu_offset_m(start, LatLon(latitude + 0.001, 8.5))
    assert (east, north) == pytest.approx((0.0, north_m_deg / 1000), abs=2e-3)
    east, north = enu_offset_m(start, LatLon(latitude, 8.501))
    assert (east, north) == pytest.approx((east_m_deg / 1000, 0.0), abs=2e-3)


def test_golden_offset_between_two_surveyed_places() -> None:
    # Flinders Peak to Buninyong, the worked example of the Geocentric Datum of Australia's technical manual:
    # 54972.271 m along the ground at azimuth 306 deg 52' 05.37"; the plane shortens it by s^3 / 6R^2.
    flinders = LatLon(-(37 + 57 / 60 + 3.72030 / 3600), 144 + 25 / 60 + 29.52440 / 3600)
    buninyong = LatLon(-(37 + 39 / 60 + 10.15610 / 3600), 143 + 55 / 60 + 35.38390 / 3600)
    assert vincenty(flinders, buninyong)[0] == pytest.approx(54_972.271, abs=2e-3)
    length = 54_972.271 - 54_972.271**3 / (6 * 6.372e6**2)
    azimuth = math.radians(306 + 52 / 60 + 5.37 / 3600)
    expected = (length * math.sin(azimuth), length * math.cos(azimuth))
    assert enu_offset_m(flinders, buninyong) == pytest.approx(expected, abs=0.02)


def test_the_date_line_is_no_wall() -> None:
    east, north = enu_offset_m(LatLon(-17.0, 179.9995), LatLon(-17.0, -179.9995))
    assert 0 < east < 110
    assert north == pytest.approx(0.0, abs=1e-3)
    assert place_at_offset(LatLon(-17.0, 179.9995), east, north).longitude_deg == pytest.approx(-179.9995, abs=1e-9)


def test_places_too_far_apart_have_no_offset() -> None:
    with pytest.raises(GeometryError, match="km apart"):
        enu_offset_m(LatLon(47.0, 8.0), LatLon(-47.0, -172.0))
    with pytest.raises(GeometryError, match="longer than"):
        place_at_offset(LatLon(47.0, 8.0), 2e6, 0.0)
    with pytest.raises(GeometryError, match="longer than"):
        place_at_offset(LatLon(47.0, 8.0), math.nan, 0.0)


@pytest.mark.parametrize(("latitude", "longitude"), [(91.0, 0.0), (0.0, 181.0), (math.nan, 0.0), (0.0, math.inf)])
def test_no_place_off_the_globe(latitude: float, longitude: float) -> None:
    with pytest.raises(GeometryError, match="no such place"):
        LatLon(latitude, longitude)
