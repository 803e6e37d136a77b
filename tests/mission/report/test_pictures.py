"""Where pictures were taken, in the files of photogrammetry programs."""

from math import nan, radians
from pathlib import Path

import pytest

from mission.report.pictures import GEO_FILE, IMAGES_FILE, write_pictures
from mission.report.reading import Picture, parse_record
from mission.report.record import FlightRecord

HERE = (47.3977421, 8.5455939, 498.1234)
LEVEL = (radians(1.0), radians(-2.5), radians(-90.0))


def picture(number: int, place: tuple[float, float, float] = HERE, accuracy: float = 1.5) -> Picture:
    return Picture(12.5, number, place, (1.0, 2.0, 10.0), LEVEL, (accuracy, 2.0 * accuracy))


def test_columns_of_pix4d_and_of_opendronemap(tmp_path: Path) -> None:
    write_pictures([picture(4), picture(6)], tmp_path)
    assert (tmp_path / IMAGES_FILE).read_text().splitlines() == [
        "#imagename,latitude,longitude,z,yaw,pitch,roll,accuracy horz,accuracy vert",
        "0001.JPG,47.3977421,8.5455939,498.123,270.00,-2.50,1.00,1.50,3.00",
        "0003.JPG,47.3977421,8.5455939,498.123,270.00,-2.50,1.00,1.50,3.00",
    ]
    assert (tmp_path / GEO_FILE).read_text().splitlines() == [
        "EPSG:4326",
        "0001.JPG 8.5455939 47.3977421 498.123 270.00 -2.50 1.00 1.50 3.00",
        "0003.JPG 8.5455939 47.3977421 498.123 270.00 -2.50 1.00 1.50 3.00",
    ]


def test_accuracies_are_left_out_where_one_is_not_known_and_pictures_without_a_place_too(tmp_path: Path) -> None:
    write_pictures([picture(0), picture(1, (nan, nan, nan)), picture(2, accuracy=nan)], tmp_path)
    head, *rows = (tmp_path / IMAGES_FILE).read_text().splitlines()
    assert head.count(",") == rows[0].count(",") == 6
    assert [row[:8] for row in rows] == ["0001.JPG", "0003.JPG"]


@pytest.mark.parametrize("pictures", [[], [picture(1, (nan, nan, nan))]])
def test_without_places_there_are_no_files(tmp_path: Path, pictures: list[Picture]) -> None:
    write_pictures(pictures, tmp_path)
    assert not list(tmp_path.iterdir())


def test_what_is_recorded_of_a_picture_is_read_again(tmp_path: Path) -> None:
    record = FlightRecord.in_folder(tmp_path, "survey")
    known = {"latitude_deg": 47.0, "longitude_deg": 8.0, "altitude_amsl_m": 420.0, "position_m": (1.0, 2.0, 3.0)}
    rest = {"attitude_rad": (0.1, 0.2, 0.3), "accuracy_m": None, "height_accuracy_m": None, "trajectory_s": None}
    record.write("image", 12.5, number=3, utc_us=None, **known, **rest)
    record.close()
    assert record.folder is not None
    (found,) = parse_record((record.folder / "record.jsonl").read_bytes()).pictures
    assert (found.t_s, found.number, found.place, found.position_m) == (12.5, 3, (47.0, 8.0, 420.0), (1.0, 2.0, 3.0))
    assert found.attitude_rad == (0.1, 0.2, 0.3)
    assert str(found.accuracy_m) == "(nan, nan)"
