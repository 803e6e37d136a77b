"""The camera alone: what triggers it, by made-up estimates."""

from itertools import pairwise
from math import radians
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.drawn_cases import tried
from vehicle_sim.camera import Camera, camera_of
from vehicle_sim.parameters import Flavour, ParameterStore, default_parameters
from vehicle_sim.signals import CameraOrder, Estimate, EstimatorFlag, Geodetic
from vehicle_sim.vehicle import Vehicle, VehicleConfig

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
STEP_S, SPEED_M_S = 0.01, 4.0
EVERY_5_M = {
    AP: CameraOrder(distance_m=5.0),
    PX4: CameraOrder(distance_m=5.0, enabled=True, paused=False),
}
OFF = {AP: CameraOrder(distance_m=0.0), PX4: CameraOrder(paused=True)}
_BLANK = Vehicle(VehicleConfig()).estimate
ESTIMATE = _BLANK._replace(
    origin=Geodetic(47.0, 8.0, 400.0),
    status=_BLANK.status._replace(flags=EstimatorFlag.POSITION_HORIZONTAL_ABSOLUTE),
)
BOTH = pytest.mark.parametrize("flavour", Flavour)


class Bench:
    """A camera that is carried eastwards."""

    def __init__(self, flavour: Flavour, **parameters: float) -> None:
        self.parameters: ParameterStore = default_parameters(flavour)
        for name, value in parameters.items():
            self.parameters.set(name, value)
        camera = camera_of(self.parameters)
        assert camera is not None
        self.camera: Camera = camera
        self.estimate = ESTIMATE
        self.steps = 0
        self.taken: list[Estimate] = []
        self.numbers: list[int] = []

    def fly(self, metres: float, *, in_mission: bool = False, **change: Any) -> None:  # noqa: ANN401 - any field
        for _ in range(round(metres / (SPEED_M_S * STEP_S))):
            self.steps += 1
            place = (0.0, self.steps * SPEED_M_S * STEP_S, -10.0)
            estimate = self.estimate._replace(time_s=self.steps * STEP_S, position_ned_m=place)._replace(**change)
            self.camera.step(estimate, in_mission=in_mission)
            while self.camera.news:
                photo = self.camera.news.popleft()
                self.taken.append(photo.estimate)
                self.numbers.append(photo.number)

    @property
    def places(self) -> list[float]:
        return [estimate.position_ned_m[1] for estimate in self.taken]


@BOTH
def test_by_distance_pictures_are_as_far_apart_as_asked(flavour: Flavour) -> None:
    bench = Bench(flavour)
    bench.fly(3.0)
    assert not bench.taken
    bench.camera.take(EVERY_5_M[flavour])
    bench.fly(41.0)
    # PX4 begins with a picture, ArduPilot after the first five metres.
    assert len(bench.taken) == (9 if flavour is PX4 else 8)
    gaps = [after - before for before, after in pairwise(bench.places)]
    assert all(5.0 <= gap < 5.0 + SPEED_M_S * STEP_S + 1e-9 for gap in gaps)
    bench.camera.take(OFF[flavour])
    before = len(bench.taken)
    bench.fly(20.0)
    assert len(bench.taken) == before == bench.camera.taken


@BOTH
def test_a_picture_asked_for_at_once_is_the_first_of_the_row(flavour: Flavour) -> None:
    bench = Bench(flavour)
    bench.fly(3.0)
    assert bench.camera.take(EVERY_5_M[flavour]._replace(shoots=True))
    bench.fly(11.0)
    assert bench.places == pytest.approx([3.0, 8.0, 13.0], abs=0.09)
    assert bench.numbers == ([1, 2, 3] if flavour is AP else [0, 1, 2])


@BOTH
def test_distances_are_measured_anew_after_a_pause(flavour: Flavour) -> None:
    bench = Bench(flavour)
    bench.fly(1.0)
    bench.camera.take(EVERY_5_M[flavour]._replace(shoots=True))
    bench.fly(4.0)
    bench.camera.take(OFF[flavour])
    bench.fly(50.0)
    bench.camera.take(EVERY_5_M[flavour]._replace(shoots=True))
    bench.fly(6.0)
    assert bench.places == pytest.approx([1.0, 55.0, 60.0], abs=0.09)


@BOTH
def test_without_a_position_nothing_is_taken_by_distance(flavour: Flavour) -> None:
    bench = Bench(flavour)
    lost = bench.estimate.status._replace(flags=EstimatorFlag(0))
    bench.camera.take(EVERY_5_M[flavour])
    bench.fly(12.0, origin=None, status=lost)
    assert not bench.taken


@BOTH
def test_pictures_are_not_closer_in_time_than_the_camera_can(flavour: Flavour) -> None:
    bench = Bench(flavour, **({"CAM1_INTRVAL_MIN": 2.0} if flavour is AP else {"TRIG_MIN_INTERVA": 2000.0}))
    bench.fly(1.0)
    bench.camera.take(EVERY_5_M[flavour]._replace(shoots=True))
    bench.fly(40.0)
    times = [estimate.time_s for estimate in bench.taken]
    assert len(times) > 3
    assert all(after - before >= 2.0 - 1e-9 for before, after in pairwise(times))
    before = len(bench.taken)
    while len(bench.taken) == before:
        bench.fly(0.04)
    assert not bench.camera.take(CameraOrder(shoots=True))
    before = len(bench.taken)
    bench.camera.take(OFF[flavour])
    bench.fly(40.0)
    # What ArduPilot could not take at once it takes as soon as it can; PX4 refused it.
    assert len(bench.taken) == before + (flavour is AP)


def test_no_camera_where_the_parameters_at_boot_say_so() -> None:
    for flavour, name in ((AP, "CAM1_TYPE"), (PX4, "TRIG_MODE")):
        parameters = default_parameters(flavour)
        parameters.set(name, 0.0)
        assert camera_of(parameters) is None


def test_ardupilot_goes_by_its_parameter_until_a_command_says_otherwise() -> None:
    bench = Bench(AP, CAM1_TRIGG_DIST=10.0)
    bench.fly(31.0)
    assert len(bench.taken) == 3
    bench.camera.take(CameraOrder(distance_m=0.0))
    bench.fly(30.0)
    assert len(bench.taken) == 3
    assert bench.parameters["CAM1_TRIGG_DIST"] == 10.0  # so does the next boot
    bench.parameters.set("CAM1_TRIGG_DIST", 2.0)
    bench.fly(21.0)
    assert len(bench.taken) > 10


def test_ardupilot_may_be_kept_to_missions_and_to_little_roll() -> None:
    bench = Bench(AP, CAM_AUTO_ONLY=1.0, CAM_MAX_ROLL=10.0, CAM1_TRIGG_DIST=5.0)
    bench.fly(20.0)
    assert not bench.taken
    bench.fly(20.0, in_mission=True, roll_rad=radians(-12.0))
    assert not bench.taken
    bench.fly(20.0, in_mission=True)
    assert len(bench.taken) == 3


def test_ardupilot_takes_a_series_by_time_before_any_by_distance() -> None:
    bench = Bench(AP, CAM1_TRIGG_DIST=1.0)
    bench.fly(0.04)
    bench.camera.take(CameraOrder(interval_s=0.5, pictures=3))
    assert bench.camera.left == 3
    bench.fly(SPEED_M_S * 1.3)
    times = [estimate.time_s for estimate in bench.taken]
    assert times[:3] == pytest.approx([0.02, 0.53, 1.04], abs=0.011)
    assert bench.camera.left == 0
    bench.camera.take(CameraOrder(distance_m=0.0, interval_s=0.5, pictures=-1))
    bench.fly(SPEED_M_S * 3.0)
    assert len(bench.taken) > 7
    bench.camera.take(CameraOrder(pictures=0))
    before = len(bench.taken)
    bench.fly(20.0)
    assert len(bench.taken) == before


def test_px4_by_time_begins_when_enabled_and_ends_when_paused() -> None:
    bench = Bench(PX4, TRIG_MODE=1.0, TRIG_INTERVAL=500.0)
    bench.fly(4.0)
    assert not bench.taken
    bench.camera.take(CameraOrder(enabled=True, paused=False))
    bench.fly(SPEED_M_S * 1.2)
    assert [estimate.time_s for estimate in bench.taken] == pytest.approx([1.01, 1.51, 2.01], abs=0.011)
    bench.camera.take(CameraOrder(paused=True))
    bench.fly(8.0)
    assert len(bench.taken) == 3
    bench.camera.take(CameraOrder(paused=False, restarts=True))
    bench.fly(0.08)
    assert bench.numbers == [0, 1, 2, 0]


@pytest.mark.parametrize(("mode", "pictures"), [(2.0, 25), (3.0, 2)])
def test_px4_may_begin_unasked(mode: float, pictures: int) -> None:
    bench = Bench(PX4, TRIG_MODE=mode, TRIG_DISTANCE=25.0, TRIG_INTERVAL=400.0)
    bench.fly(40.0)
    assert len(bench.taken) == pictures


ORDERS = st.builds(
    CameraOrder,
    shoots=st.booleans(),
    distance_m=st.none() | st.floats(0.0, 20.0),
    interval_s=st.none() | st.floats(0.1, 2.0),
    pictures=st.none() | st.integers(-1, 4),
    enabled=st.none() | st.booleans(),
    paused=st.none() | st.booleans(),
    restarts=st.just(value=False),
)


@tried(20)
@given(flavour=st.sampled_from(Flavour), orders=st.lists(st.tuples(ORDERS, st.floats(0.0, 4.0)), max_size=5))
def test_whatever_it_is_told_pictures_are_numbered_in_order_and_later_than_the_last(
    flavour: Flavour, orders: list[tuple[CameraOrder, float]]
) -> None:
    bench = Bench(flavour)
    for order, metres in orders:
        bench.camera.take(order)
        bench.fly(metres)
    bench.fly(0.04)
    first = 1 if flavour is AP else 0
    assert bench.numbers == list(range(first, first + len(bench.taken)))
    assert bench.camera.taken == len(bench.taken)
    times = [estimate.time_s for estimate in bench.taken]
    assert times == sorted(set(times)) or flavour is AP  # ArduPilot takes one at each request, also twice in a step
