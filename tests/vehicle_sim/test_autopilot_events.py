"""Random requests at random moments: the autopilot never raises and keeps what must always hold."""

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from tests.support.bare_vehicle import booted, run
from tests.support.fences import at_home, circle, fenced, ring
from vehicle_sim.autopilot import Command, Datum, MissionItem, Mode, Outcome, Place, SpeedAxis
from vehicle_sim.autopilot.rally import RallyPoint
from vehicle_sim.parameters import ALL_FENCES, Flavour
from vehicle_sim.signals import Setpoint
from vehicle_sim.vehicle import Vehicle, VehicleConfig

PLACES = st.none() | st.builds(
    lambda lat, lon, height, datum: Place(None if lat is None else 47.397742 + lat, 8.545594 + lon, height, datum),
    st.none() | st.floats(-3e-4, 3e-4),
    st.floats(-3e-4, 3e-4),
    st.none() | st.floats(-5.0, 30.0),
    st.sampled_from(Datum),
)
ITEMS = st.builds(
    MissionItem,
    command=st.sampled_from(Command),
    place=PLACES,
    seconds=st.floats(0.0, 5.0),
    radius_m=st.floats(0.0, 20.0),
    turns=st.floats(0.0, 2.0),
    clockwise=st.booleans(),
    yaw_rad=st.none() | st.floats(-7.0, 7.0),
    axis=st.none() | st.sampled_from(SpeedAxis),
    speed_m_s=st.floats(-1.0, 15.0),
    target=st.integers(-1, 7),
    repeats=st.integers(-1, 3),
    continues=st.booleans(),
)
HOME_ITEM = (MissionItem(command=Command.WAYPOINT),)
PARTIAL = st.tuples(*[st.none() | st.floats(-30.0, 30.0)] * 3)


class Requests(RuleBasedStateMachine):
    """A vehicle of either flavour under arbitrary requests."""

    vehicle: Vehicle
    left_ground_armed: bool

    @initialize(flavour=st.sampled_from(Flavour), is_booted=st.booleans())
    def switch_on(self, flavour: Flavour, *, is_booted: bool) -> None:
        self.vehicle = booted(flavour) if is_booted else Vehicle(VehicleConfig(flavour=flavour))
        self.was_flying = False

    @rule(seconds=st.sampled_from([0.05, 0.5, 3.0]))
    def wait(self, seconds: float) -> None:
        run(self.vehicle, seconds)

    @rule(force=st.booleans())
    def arm(self, *, force: bool) -> None:
        autopilot = self.vehicle.autopilot
        was_armed, ready = autopilot.armed, autopilot.ready_to_arm
        outcome = autopilot.arm(force=force)
        assert (outcome is Outcome.ACCEPTED) == autopilot.armed
        if autopilot.armed and not was_armed and not force:
            assert ready

    @rule(force=st.booleans())
    def disarm(self, *, force: bool) -> None:
        autopilot = self.vehicle.autopilot
        flying = autopilot.flying and autopilot.armed
        outcome = autopilot.disarm(force=force)
        assert (outcome is Outcome.ACCEPTED) == (force or not flying)

    @rule(mode=st.sampled_from(Mode))
    def set_mode(self, mode: Mode) -> None:
        autopilot = self.vehicle.autopilot
        before = autopilot.mode
        outcome = autopilot.set_mode(mode)
        if mode not in autopilot.modes:
            assert outcome is Outcome.DENIED
        assert autopilot.mode in (before, mode)
        if outcome is not Outcome.ACCEPTED:
            assert autopilot.mode is before

    @rule(height=st.none() | st.floats(-5.0, 30.0) | st.just(float("inf")))
    def takeoff(self, height: float | None) -> None:
        self.vehicle.autopilot.takeoff(height)

    @rule(name=st.sampled_from(["land", "return_to_launch", "hold", "pause", "resume", "set_home"]))
    def request(self, name: str) -> None:
        assert isinstance(getattr(self.vehicle.autopilot, name)(), Outcome)

    @rule(position=PARTIAL, velocity=PARTIAL, acceleration=PARTIAL, yaw=st.none() | st.floats(-4.0, 4.0))
    def setpoint(
        self,
        position: tuple[float | None, float | None, float | None],
        velocity: tuple[float | None, float | None, float | None],
        acceleration: tuple[float | None, float | None, float | None],
        yaw: float | None,
    ) -> None:
        self.vehicle.autopilot.setpoint(
            Setpoint(
                position_ned_m=position,
                velocity_ned_m_s=velocity,
                acceleration_ned_m_s2=acceleration,
                yaw_rad=yaw,
            )
        )

    @rule(place=PARTIAL, change=st.booleans())
    def reposition(self, place: tuple[float | None, float | None, float | None], *, change: bool) -> None:
        self.vehicle.autopilot.reposition(place, change_mode=change)

    @rule(speed=st.floats(-1.0, 15.0), axis=st.sampled_from(SpeedAxis), yaw=st.floats(-10.0, 10.0))
    def trim(self, speed: float, axis: SpeedAxis, yaw: float) -> None:
        self.vehicle.autopilot.change_speed(speed, axis)
        self.vehicle.autopilot.turn(yaw, relative=speed > 0.0)
        self.vehicle.autopilot.halt()

    @rule(mission=st.lists(ITEMS, max_size=6), current=st.none() | st.just(0))
    def load_mission(self, mission: list[MissionItem], current: int | None) -> None:
        self.vehicle.autopilot.load_mission((*HOME_ITEM, *mission), current)

    @rule(first=st.none() | st.integers(0, 3))
    def start_mission(self, first: int | None) -> None:
        self.vehicle.autopilot.start_mission(first)

    @rule(index=st.integers(-1, 7), resets=st.booleans())
    def choose(self, index: int, *, resets: bool) -> None:
        mission = self.vehicle.autopilot.mission
        if mission.set_current(index, resets_jumps=resets):
            assert 0 <= mission.current < len(mission.items)

    @rule()
    def clear_mission(self) -> None:
        self.vehicle.autopilot.load_mission(())
        assert not self.vehicle.autopilot.mission.present

    @rule(system_id=st.sampled_from([245, 255]))
    def heartbeat(self, system_id: int) -> None:
        self.vehicle.autopilot.heartbeat_from_ground(system_id, self.vehicle.time_s)

    @rule(value=st.integers(0, 7))
    def tune(self, value: int) -> None:
        name = {Flavour.ARDUPILOT: "FS_GCS_ENABLE", Flavour.PX4: "COM_OBL_RC_ACT"}[self.vehicle.autopilot.flavour]
        self.vehicle.parameters.set(name, value)

    @rule(
        reach=st.floats(1.0, 40.0),
        north=st.floats(-60.0, 60.0),
        contains=st.booleans(),
        action=st.integers(0, 5),
        on=st.booleans(),
    )
    def fence(self, *, reach: float, north: float, contains: bool, action: int, on: bool) -> None:
        vehicle = self.vehicle
        if vehicle.autopilot.home is None:
            return
        names = {Flavour.ARDUPILOT: "FENCE_ACTION", Flavour.PX4: "GF_ACTION"}
        areas = (ring(vehicle, reach, north=north, contains=contains), circle(vehicle, reach, contains=not contains))
        fenced(vehicle, *(areas if on else ()), **{names[vehicle.autopilot.flavour]: action})
        if vehicle.autopilot.flavour is Flavour.ARDUPILOT:
            vehicle.autopilot.guard.fence.switch(ALL_FENCES, on=on)
        vehicle.autopilot.rally = (RallyPoint(at_home(vehicle, north, reach), reach),) if on else ()

    @invariant()
    def nothing_leaves_the_ground_disarmed(self) -> None:
        autopilot = self.vehicle.autopilot
        if not autopilot.armed:
            assert autopilot.target is None
            if self.vehicle.truth.on_ground:
                run(self.vehicle, 0.03)
                assert self.vehicle.truth.on_ground

    @invariant()
    def the_mode_is_one_of_the_flavour(self) -> None:
        assert self.vehicle.autopilot.mode in self.vehicle.autopilot.modes

    @invariant()
    def it_stays_in_one_piece(self) -> None:
        motion = self.vehicle.truth
        assert abs(motion.roll_rad) < 1.2
        assert abs(motion.pitch_rad) < 1.2
        assert motion.position_ned_m[2] <= 0.0
        assert all(abs(speed) < 40.0 for speed in motion.velocity_ned_m_s)


TestRequests = Requests.TestCase
TestRequests.settings = settings(max_examples=15, stateful_step_count=25, deadline=None)
TestRequests = pytest.mark.timeout(110)(TestRequests)
