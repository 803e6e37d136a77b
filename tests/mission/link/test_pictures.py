"""What a vehicle tells of its pictures, as messages and as what the flight makes of them."""

from collections import deque
from math import radians
from typing import TYPE_CHECKING

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.course import Course
from mission.link.events import Photographed
from mission.link.frames import Anchor
from mission.link.guidance import Guidance
from mission.link.messages import Codec
from mission.link.pictures import PictureBook
from mission.link.values import Fix, GlobalPosition, Image, Origin
from mission.link.vehicle_state import VehicleState
from tests.support.sessions import Straight

if TYPE_CHECKING:
    from mission.link.events import Event

NAN = float("nan")


def read(message: mavlink.MAVLink_message) -> object:
    frame = message.pack(mavlink.MAVLink(None, srcSystem=1, srcComponent=1))
    (received,) = Codec(255, 191).decode(bytes(frame))
    return received.body


def test_feedback_of_ardupilot() -> None:
    message = mavlink.MAVLink_camera_feedback_message(
        1_700_000_000_123_456, 0, 0, 7, 473_977_420, 85_455_940, 498.5, 10.5, 1.0, -2.0, 90.0, 0.0, 0, 0
    )
    image = read(message)
    assert isinstance(image, Image)
    assert (image.number, image.boot_s, image.utc_us) == (7, None, 1_700_000_000_123_456)
    assert image.place == pytest.approx((47.397742, 8.545594, 498.5))
    assert image.angles_rad == pytest.approx((radians(1.0), radians(-2.0), radians(90.0)))


def test_image_of_px4() -> None:
    half = 0.5**0.5
    head = (12_340, 0, 1, 473_977_420, 85_455_940, 498_500, -1000)
    image = read(mavlink.MAVLink_camera_image_captured_message(*head, (half, 0.0, 0.0, half), 3, 1, b""))
    assert isinstance(image, Image)
    assert (image.number, image.boot_s, image.utc_us, image.captured) == (3, 12.34, 0, True)
    assert image.place == pytest.approx((47.397742, 8.545594, 498.5))
    assert image.angles_rad == pytest.approx((0.0, 0.0, radians(90.0)))
    failed = read(mavlink.MAVLink_camera_image_captured_message(*head, (NAN,) * 4, 3, 0, b""))
    assert isinstance(failed, Image)
    assert (failed.captured, failed.angles_rad) == (False, None)


def test_release_of_px4_and_accuracy_of_a_receiver() -> None:
    image = read(mavlink.MAVLink_camera_trigger_message(12_340_900, 3))
    assert image == Image(3, 12_340, 12.3409, 0, None, None, released=True)
    place = (3, 473_977_420, 85_455_940, 498_000, 80, 90, 0, 0, 12)
    assert read(mavlink.MAVLink_gps_raw_int_message(0, *place, 0, 1500, 2500, 0, 0)) == Fix((1.5, 2.5), 3, 12, 0.8)
    assert read(mavlink.MAVLink_gps_raw_int_message(0, *place)) == Fix(None, 3, 12, 0.8)
    unsaid = (0, 0, 0, 0, 65535, 65535, 0, 0, 255)
    assert read(mavlink.MAVLink_gps_raw_int_message(0, *unsaid)) == Fix(None)


class Book:
    """A book of a vehicle that has told where it is."""

    def __init__(self) -> None:
        self.events: deque[Event] = deque()
        self.vehicle = VehicleState()
        self.book = PictureBook(self.vehicle, self.events)

    @property
    def told(self) -> list[Photographed]:
        return [event for event in self.events if isinstance(event, Photographed)]


IMAGE = Image(4, 9_000, 9.0, 0, (47.0001, 8.0, 420.0), (0.1, 0.2, 0.3))
RELEASE = Image(4, 9_000, 9.0004, 0, None, None, released=True)


@pytest.mark.parametrize("messages", [(IMAGE,), (RELEASE, IMAGE), (IMAGE, RELEASE), (RELEASE, IMAGE, IMAGE, RELEASE)])
def test_a_picture_counts_once_however_often_it_is_told(messages: tuple[Image, ...]) -> None:
    bench = Book()
    for message in messages:
        bench.book.take(message, 9.1)
    bench.book.advance(99.0)
    (picture,) = bench.told
    assert (picture.number, picture.t_s, picture.place) == (4, 9.0, IMAGE.place)


def test_a_release_without_an_image_counts_where_the_vehicle_was() -> None:
    bench = Book()
    bench.vehicle.take(GlobalPosition(8_990, 47.0, 8.0, 430.0, 10.0), 9.0)
    bench.book.take(RELEASE, 9.0)
    bench.book.advance(9.9)
    assert not bench.told
    bench.book.advance(10.2)
    (picture,) = bench.told
    assert picture.place == (47.0, 8.0, 430.0)


def test_pictures_of_the_same_number_at_another_time_are_others_and_failed_ones_are_none() -> None:
    bench = Book()
    bench.book.take(IMAGE, 9.1)
    bench.book.take(Image(4, 20_000, 20.0, 0, None, None), 20.1)
    bench.book.take(Image(5, 21_000, 21.0, 0, None, None, captured=False), 21.1)
    assert [picture.t_s for picture in bench.told] == [9.0, 20.0]


def test_a_place_becomes_one_in_the_domain() -> None:
    bench = Book()
    bench.vehicle.take(Origin(47.0, 8.0, 410.0), 0.0)
    bench.vehicle.take(Fix((1.2, 1.9)), 0.0)
    bench.book.guidance = Guidance(Course(Straight(), 0.0), Anchor((5.0, 7.0, 0.0)), 0.1)
    bench.book.take(IMAGE, 9.1)
    (picture,) = bench.told
    assert picture.position_m == pytest.approx((-7.0, 6.117, 10.0), abs=0.01)
    assert picture.accuracy_m == (1.2, 1.9)
    assert picture.trajectory_s is None
