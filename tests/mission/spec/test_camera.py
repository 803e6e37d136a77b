"""Spacing and trigger distance, beside numbers that makers and photogrammetry programs give."""

import pytest

from mission.errors import GeometryError
from mission.spec.camera import Lens, lane_spacing_m, trigger_distance_m

FULL_FRAME = Lens.of_sensor(36.0, 24.0, 50.0)


def test_a_full_frame_with_a_lens_of_50_mm_sees_40_degrees_by_27() -> None:
    lens = Lens.of_view(39.5978, 26.9915)
    assert (lens.width, lens.height) == pytest.approx((FULL_FRAME.width, FULL_FRAME.height), rel=1e-4)


def test_spacing_and_trigger_distance_follow_from_what_pictures_share() -> None:
    assert lane_spacing_m(FULL_FRAME, 100.0, 0.0) == pytest.approx(72.0)
    assert lane_spacing_m(FULL_FRAME, 100.0, 0.65) == pytest.approx(25.2)
    assert trigger_distance_m(FULL_FRAME, 100.0, 0.75) == pytest.approx(12.0)


@pytest.mark.parametrize(
    ("altitude_m", "sidelap", "said"),
    [(0.0, 0.5, "altitude"), (float("nan"), 0.5, "altitude"), (50.0, 1.0, "sidelap"), (50.0, -0.1, "sidelap")],
)
def test_what_gives_no_spacing_is_refused(altitude_m: float, sidelap: float, said: str) -> None:
    with pytest.raises(GeometryError, match=said):
        lane_spacing_m(FULL_FRAME, altitude_m, sidelap)


def test_no_camera_sees_half_of_everything_or_nothing() -> None:
    for angle_deg in (180.0, 0.0, float("inf")):
        with pytest.raises(GeometryError, match="angle of view"):
            Lens.of_view(angle_deg, 30.0)
    with pytest.raises(GeometryError, match="focal length"):
        Lens.of_sensor(36.0, 24.0, 0.0)
