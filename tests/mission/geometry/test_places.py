"""Many places at once are those of the closed form for one."""

import numpy as np
import pytest

from mission.errors import GeometryError
from mission.geometry.geodesy import LatLon, place_at_offset
from mission.geometry.places import places_at_offsets


@pytest.mark.parametrize(
    "place", [LatLon(47.4, 8.5), LatLon(-89.9, 12.0), LatLon(0.0, 179.9999), LatLon(90.0, 0.0), LatLon(-35.0, -180.0)]
)
def test_each_is_the_place_of_its_offset(place: LatLon) -> None:
    offsets = np.random.default_rng(3).uniform(-40_000.0, 40_000.0, (40, 2))
    for (east_m, north_m), (latitude, longitude) in zip(offsets, places_at_offsets(place, offsets), strict=True):
        one = place_at_offset(place, east_m, north_m)
        assert latitude == pytest.approx(one.latitude_deg, abs=1e-12)
        assert longitude == pytest.approx(one.longitude_deg, abs=1e-9)


def test_what_is_too_far_is_refused() -> None:
    with pytest.raises(GeometryError, match="1000 km"):
        places_at_offsets(LatLon(0.0, 0.0), np.array([[0.0, 0.0], [0.0, 2e6]]))
