import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.drawn_cases import tried
from vehicle_sim.geodesy import geodetic_at, ned_offset_m
from vehicle_sim.signals import Geodetic, Vector

PLACES = st.builds(Geodetic, st.floats(-80.0, 80.0), st.floats(-180.0, 179.999), st.floats(-100.0, 4000.0))
OFFSETS = st.tuples(st.floats(-20e3, 20e3), st.floats(-20e3, 20e3), st.floats(-500.0, 500.0))


def earth_centred(place: Geodetic, altitude_m: float) -> NDArray[np.float64]:
    """The textbook's conversion, with semi-axes instead of flattening and eccentricity."""
    a, b = 6378137.0, 6356752.314245179
    lat, lon = np.radians(place.lat_deg), np.radians(place.lon_deg)
    n = a * a / np.sqrt((a * np.cos(lat)) ** 2 + (b * np.sin(lat)) ** 2)
    return np.array(
        [
            (n + altitude_m) * np.cos(lat) * np.cos(lon),
            (n + altitude_m) * np.cos(lat) * np.sin(lon),
            (n * b * b / (a * a) + altitude_m) * np.sin(lat),
        ]
    )


@tried(100)
@given(origin=PLACES, offset=OFFSETS)
def test_there_and_back(origin: Geodetic, offset: Vector) -> None:
    there = geodetic_at(origin, offset)
    assert np.allclose(ned_offset_m(origin, there), offset, atol=1e-6)
    assert -180.0 <= there.lon_deg < 180.0


@tried(100)
@given(origin=PLACES, offset=OFFSETS)
def test_offsets_are_the_chord_on_the_tangent_plane(origin: Geodetic, offset: Vector) -> None:
    point = geodetic_at(origin, offset)
    chord = earth_centred(point, origin.alt_m) - earth_centred(origin, origin.alt_m)
    lat, lon = np.radians(origin.lat_deg), np.radians(origin.lon_deg)
    north = np.array([-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)])
    east = np.array([-np.sin(lon), np.cos(lon), 0.0])
    assert np.allclose((chord @ north, chord @ east), ned_offset_m(origin, point)[:2], atol=1e-6)


def test_down_is_the_difference_of_altitudes() -> None:
    here = Geodetic(47.0, 8.0, 400.0)
    assert ned_offset_m(here, Geodetic(47.0, 8.0, 430.0)) == (0.0, 0.0, -30.0)


def test_the_date_line_is_no_border() -> None:
    north, east, _ = ned_offset_m(Geodetic(10.0, 179.9999, 0.0), Geodetic(10.0, -179.9999, 0.0))
    assert abs(north) < 1e-3
    assert 21.0 < east < 22.5
