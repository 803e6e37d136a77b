"""The geofence is set and put back as it was, over links that lose, double and mix, against the bundled vehicle."""

import math
import random
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.errors import LinkError, VehicleError
from mission.geometry.geodesy import LatLon
from mission.interchange.autopilot_plan import FenceCircle, FencePolygon
from mission.link.connection import AUTOPILOTS
from mission.link.exchanges import ATTEMPTS, Asking, PlanReading, PlanWriting, Question
from mission.link.fence_guard import FenceGuard, fence_items
from mission.link.messages import AUTOPILOT_ARDUPILOT, AUTOPILOT_PX4, Codec
from mission.link.plan_values import Partner, PlanAnswer, PlanCount, PlanItem, PlanKind, PlanPart, PlanRequest
from mission.link.values import Body
from tests.support.lockstep import LockstepVehicle, vehicle_of
from vehicle_sim.protocol import plan_store

KINDS = {"ardupilot": AUTOPILOTS[AUTOPILOT_ARDUPILOT], "px4": AUTOPILOTS[AUTOPILOT_PX4]}
BOTH = tuple(KINDS)
OWN = Partner(255, 191)
HERE = LatLon(47.397742, 8.545594)


def around(half_deg: float, *, inclusion: bool, north_deg: float = 0.0) -> FencePolygon:
    lat, lon = HERE.latitude_deg + north_deg, HERE.longitude_deg
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return FencePolygon(inclusion, tuple(LatLon(lat + a * half_deg, lon + b * half_deg) for a, b in corners))


OURS = fence_items(
    [
        around(2e-3, inclusion=True),
        around(2e-4, inclusion=False, north_deg=1e-3),
        FenceCircle(False, LatLon(HERE.latitude_deg - 1e-3, HERE.longitude_deg), 12.34),
    ]
)
THEIRS = fence_items([around(5e-3, inclusion=True), FenceCircle(False, LatLon(47.4, 8.55), 30.0)])
OWNERS = {
    "ardupilot": {"FENCE_ENABLE": 1.0, "FENCE_TYPE": 3.0, "FENCE_ACTION": 1.0, "FENCE_ALT_MAX": 20.0},
    "px4": {"GF_ACTION": 3.0, "GF_MAX_HOR_DIST": 150.0, "GF_PREDICT": 1.0},
}


class Link:
    """A guard and a vehicle, and what the way between them does to frames."""

    def __init__(
        self, flavour: str, *, seed: int = 1, lose: float = 0.0, double: float = 0.0, mix: bool = False
    ) -> None:
        kind = KINDS[flavour]
        self.flavour = flavour
        self.vehicle = LockstepVehicle(vehicle_of(flavour))
        self.codec = Codec(OWN.system_id, OWN.component_id)
        self.guard = FenceGuard(OURS, kind.fence, ceiling_m=30.0, own=OWN, bytewise=kind.bytewise)
        self.lose, self.double, self.mix = lose, double, mix
        self.random = random.Random(seed)  # noqa: S311 - faults, not secrets
        self.sent = 0

    def kept(self) -> tuple[plan_store.PlanItem, ...]:
        return self.vehicle.endpoint._plans.store.plans[plan_store.PlanKind.FENCE]

    def parameters(self) -> dict[str, float]:
        store = self.vehicle.vehicle.parameters
        return {name: store[name] for name in store.names}

    def owned(self) -> None:
        """The owner's fence, given by a ground station."""
        items = tuple(
            plan_store.PlanItem(i.frame, i.command, 1, i.params, i.latitude_e7, i.longitude_e7, i.height_m)
            for i in THEIRS
        )
        assert self.vehicle.endpoint._plans._keep(plan_store.PlanKind.FENCE, items) == 0
        for name, value in OWNERS[self.flavour].items():
            self.vehicle.vehicle.parameters.set(name, value)

    def _passes(self, frames: list[bytes]) -> list[bytes]:
        often = [1 + (self.random.random() < self.double) for _ in frames]
        sent = [frame for frame, times in zip(frames, often, strict=True) for _ in range(times)]
        passed = [frame for frame in sent if self.random.random() >= self.lose]
        if self.mix:
            self.random.shuffle(passed)
        return passed

    def until_over(self, within_s: float = 400.0, most: float = math.inf) -> None:
        """Go on until the guard has nothing more to do, or has sent so many messages."""
        most += self.sent
        vehicle, until_s = self.vehicle, self.vehicle.now_s() + within_s
        while self.guard._task is not None and self.sent < most:
            assert vehicle.now_s() < until_s
            frames = [self.codec.packed(message) for message in self.guard.advance(1, vehicle.now_s())]
            self.sent += len(frames)
            for frame in self._passes(frames):
                vehicle.send(frame)
            for data in self._passes(vehicle.receive(min(self.guard.wait_s(vehicle.now_s()), 0.1))):
                for received in self.codec.decode(data):
                    self.guard.take(received.body)


def as_sent(items: tuple[plan_store.PlanItem, ...]) -> tuple[PlanItem, ...]:
    return tuple(PlanItem(i.frame, i.command, i.params, i.x, i.y, i.z) for i in items)


WAYS = st.builds(
    lambda seed, lose, double, mix: lambda flavour: Link(flavour, seed=seed, lose=lose, double=double, mix=mix),
    st.integers(0, 2**32),
    st.sampled_from([0.0, 0.1, 0.3]),
    st.sampled_from([0.0, 0.3]),
    st.booleans(),
)


@pytest.mark.parametrize("flavour", BOTH)
@pytest.mark.parametrize("owner", ["none", "fenced"])
@settings(max_examples=6, deadline=None)
@given(way=WAYS)
def test_what_was_there_is_there_again(flavour: str, owner: str, way: Callable[[str], Link]) -> None:
    link = way(flavour)
    if owner == "fenced":
        link.owned()
    before = link.parameters(), link.kept()
    link.until_over()
    assert link.guard.failure is None
    assert link.guard.is_set
    assert as_sent(link.kept()) == OURS
    now = link.parameters()
    assert {name: now[name] for name in link.guard.parameters} == link.guard.parameters
    link.guard.put_back()
    link.until_over()
    assert not link.guard.trouble
    assert (link.parameters(), link.kept()) == before
    assert link.sent < 90 or link.lose + link.double > 0


@pytest.mark.parametrize("flavour", BOTH)
def test_limits_that_the_owner_set_stay_or_get_tighter(flavour: str) -> None:
    """An owner's fence that was off is not woken up; one that was on stays on."""
    wanted = KINDS[flavour].fence.wanted
    if flavour == "px4":
        off = {"GF_ACTION": 0.0, "GF_MAX_VER_DIST": 12.0, "GF_MAX_HOR_DIST": 50.0}
        assert wanted(off, 30.0) == {"GF_MAX_VER_DIST": 30.0, "GF_MAX_HOR_DIST": 0.0, "GF_PREDICT": 0.0}
        on = wanted({**off, "GF_ACTION": 3.0}, 30.0)
        assert on == {"GF_MAX_VER_DIST": 12.0, "GF_MAX_HOR_DIST": 50.0, "GF_PREDICT": 0.0}
        return
    off = {"FENCE_ENABLE": 0.0, "FENCE_TYPE": 7.0, "FENCE_ALT_MAX": 12.0, "FENCE_OPTIONS": 3.0}
    assert wanted(off, 30.0) == {"FENCE_TYPE": 5.0, "FENCE_ACTION": 4.0, "FENCE_ALT_MAX": 30.0, "FENCE_OPTIONS": 2.0}
    on = wanted({**off, "FENCE_ENABLE": 1.0}, 30.0)
    assert (on["FENCE_TYPE"], on["FENCE_ALT_MAX"]) == (7.0, 12.0)


@pytest.mark.parametrize("flavour", BOTH)
def test_the_fence_is_off_while_it_is_half_of_one(flavour: str) -> None:
    """At every moment the vehicle watches the owner's areas by the owner's rules, ours by ours, or none at all."""
    link = Link(flavour)
    link.owned()
    watch = link.vehicle.vehicle.autopilot.guard.fence
    switch, action = KINDS[flavour].fence.switch, {"ardupilot": "FENCE_ACTION", "px4": "GF_ACTION"}[flavour]
    seen = set()

    def look(lockstep: LockstepVehicle) -> None:
        store = lockstep.vehicle.parameters
        if store[switch] > 0:
            seen.add((len(watch.plan.areas), store[action]))

    link.vehicle._at_step = look
    link.until_over()
    link.guard.put_back()
    link.until_over()
    ours = {"ardupilot": 4.0, "px4": 2.0}[flavour]
    assert seen <= {(2, OWNERS[flavour][action]), (3, ours)}
    assert len(seen) == 2


def taken_up(link: Link, earlier: FenceGuard) -> FenceGuard:
    """What guards the same flight in the stead of a program that was killed."""
    kind = KINDS[link.flavour]
    return FenceGuard(
        earlier.items,
        kind.fence,
        ceiling_m=30.0,
        own=OWN,
        bytewise=kind.bytewise,
        before=earlier.before,
        earlier=(OURS,),
    )


@pytest.mark.parametrize("flavour", BOTH)
@pytest.mark.parametrize("asked", [0, 1, 2, 4, 6, 9])
def test_one_that_was_being_renewed_when_the_program_was_killed_is_set_by_the_next(flavour: str, asked: int) -> None:
    link = Link(flavour)
    link.owned()
    link.until_over()
    link.guard.renew(OURS[:-1])
    link.until_over(most=asked)
    link.guard = taken_up(link, link.guard)
    link.guard.confirm()
    link.until_over()
    rules = KINDS[flavour].fence
    assert link.parameters()[rules.switch] == rules.on
    assert as_sent(link.kept()) == OURS[:-1]
    link.guard.put_back()
    link.until_over()
    assert not link.guard.trouble
    assert as_sent(link.kept()) == THEIRS


@pytest.mark.parametrize("flavour", BOTH)
def test_one_that_is_kept_is_left_on_when_a_flight_is_taken_up(flavour: str) -> None:
    link = Link(flavour)
    link.until_over()
    switch = KINDS[flavour].fence.switch
    link.vehicle._at_step = lambda lockstep: on.add(lockstep.vehicle.parameters[switch])
    on: set[float] = set()
    link.guard = taken_up(link, link.guard)
    link.guard.confirm()
    link.until_over()
    assert on == {KINDS[flavour].fence.on}


@pytest.mark.parametrize("flavour", BOTH)
def test_a_vehicle_that_is_gone_is_told_of(flavour: str) -> None:
    link = Link(flavour, lose=1.0)
    link.until_over()
    assert isinstance(link.guard.failure, LinkError)
    assert not link.guard.unfinished
    link = Link(flavour)
    link.until_over()
    link.lose = 1.0
    link.guard.put_back()
    began_s = link.vehicle.now_s()
    link.until_over()
    assert link.vehicle.now_s() - began_s < 15.0
    assert all(name in link.guard.trouble for name in KINDS[flavour].fence.parameters)
    assert "0 items" in link.guard.trouble


@pytest.mark.parametrize("flavour", BOTH)
def test_a_fence_that_the_vehicle_does_not_keep_is_refused(flavour: str) -> None:
    link = Link(flavour)
    bad = OURS[0]
    link.guard.items = (bad, bad)  # a polygon of two corners that says four
    link.until_over()
    assert isinstance(link.guard.failure, VehicleError)
    assert "does not keep" in str(link.guard.failure)
    assert "--no-fence" in str(link.guard.failure)
    link.guard.put_back()
    link.until_over()
    assert not link.guard.trouble
    assert link.kept() == ()


def test_what_another_ground_station_reads_is_not_taken_for_ours() -> None:
    other = Partner(255, 190)
    reading = PlanReading(PlanKind.FENCE, OWN, "it")
    assert not reading.take(PlanCount(other, PlanKind.FENCE, 3))
    assert not reading.take(PlanCount(OWN, 0, 3))
    assert reading.take(PlanCount(OWN, PlanKind.FENCE, 1))
    assert not reading.take(PlanPart(other, PlanKind.FENCE, 0, OURS[0]))
    assert not reading.take(PlanPart(OWN, PlanKind.FENCE, 1, OURS[0]))
    assert reading.take(PlanPart(OWN, PlanKind.FENCE, 0, OURS[1]))
    assert (reading.done, reading.items) == (True, [OURS[1]])
    refused = PlanReading(PlanKind.FENCE, OWN, "it")
    refused.take(PlanAnswer(OWN, PlanKind.FENCE, 3))
    assert refused.trouble
    busy = PlanReading(PlanKind.FENCE, OWN, "it")
    busy.take(PlanAnswer(OWN, PlanKind.FENCE, 1))
    assert not busy.trouble
    busy.unanswered()
    assert busy.trouble


@pytest.mark.parametrize("flavour", BOTH)
@pytest.mark.parametrize("asked", [8, 11])
def test_one_that_was_being_uploaded_when_the_program_was_killed_is_put_back_by_the_next(
    flavour: str, asked: int
) -> None:
    """ArduPilot denies to tell its fence for the 8 s that it takes an upload that has stopped to last."""
    link = Link(flavour)
    before = link.parameters(), link.kept()
    link.until_over(most=asked)
    link.guard = taken_up(link, link.guard)
    link.guard.put_back()
    link.until_over()
    assert not link.guard.trouble
    assert (link.parameters(), link.kept()) == before


@pytest.mark.parametrize("flavour", BOTH)
def test_a_vehicle_whose_store_is_full_keeps_what_it_had(flavour: str) -> None:
    link = Link(flavour)
    link.owned()
    before = link.parameters(), link.kept()
    keepers = link.vehicle.endpoint._plans.keepers
    keepers[plan_store.PlanKind.FENCE] = lambda _items: mavlink.MAV_MISSION_NO_SPACE
    link.until_over()
    assert isinstance(link.guard.failure, VehicleError)
    assert "no space; `--no-fence`" in str(link.guard.failure)
    link.guard.put_back()
    link.until_over()
    assert not link.guard.trouble
    assert (link.parameters(), link.kept()) == before


DENIED, ERROR, UNSUPPORTED = (
    PlanAnswer(OWN, PlanKind.FENCE, result)
    for result in (mavlink.MAV_MISSION_DENIED, mavlink.MAV_MISSION_ERROR, mavlink.MAV_MISSION_UNSUPPORTED)
)


def asked(question: Question, *answers: Body) -> Question:
    """Ask it until it is over, or has been answered so; the last way is for good where it is a refusal."""
    asking = Asking(question)
    for turn in range(ATTEMPTS + len(answers) + 1):
        asking.due(1, 10.0 * turn)
        if turn < len(answers) or isinstance(answers[-1], PlanAnswer):
            asking.take(answers[min(turn, len(answers) - 1)])
    return question


@pytest.mark.parametrize("items", [(), OURS[:2]])
def test_a_refusal_that_may_pass_is_waited_for(items: tuple[PlanItem, ...]) -> None:
    parts = [PlanPart(OWN, PlanKind.FENCE, number, item) for number, item in enumerate(items)]
    reading = asked(
        PlanReading(PlanKind.FENCE, OWN, "it"), DENIED, ERROR, PlanCount(OWN, PlanKind.FENCE, len(items)), *parts
    )
    assert (reading.done, reading.trouble) == (True, "")
    requests = [PlanRequest(OWN, PlanKind.FENCE, number) for number, _ in enumerate(items)]
    accepted = PlanAnswer(OWN, PlanKind.FENCE, mavlink.MAV_MISSION_ACCEPTED)
    writing = asked(
        PlanWriting(PlanKind.FENCE, items, OWN, "it"), DENIED, *requests[:1], ERROR, *requests[1:], accepted
    )
    assert (writing.done, writing.trouble) == (True, "")


@pytest.mark.parametrize(("answer", "word"), [(DENIED, "denied"), (UNSUPPORTED, "unsupported")])
def test_a_refusal_that_does_not_pass_is_told(answer: PlanAnswer, word: str) -> None:
    for question in (PlanReading(PlanKind.FENCE, OWN, "it"), PlanWriting(PlanKind.FENCE, OURS, OWN, "it")):
        asked(question, answer)
        assert word in question.trouble
        assert not question.silent
