"""Random missions under random interference, for minutes: nothing raises, nothing races, everything stays bounded."""

import random

import pytest

from tests.support.bare_vehicle import booted, run
from vehicle_sim.autopilot import Command, Datum, MissionItem, Mode, Place, SpeedAxis
from vehicle_sim.parameters import Flavour

HOME = (47.397742, 8.545594)
pytestmark = [pytest.mark.long, pytest.mark.timeout(900)]


def item(draw: random.Random) -> MissionItem:
    here = Place(
        HOME[0] + draw.uniform(-3e-4, 3e-4), HOME[1] + draw.uniform(-3e-4, 3e-4), draw.uniform(-2, 25), Datum.HOME
    )
    return MissionItem(
        command=draw.choice(list(Command)),
        place=draw.choice([None, here, here]),
        seconds=draw.uniform(0.0, 4.0),
        radius_m=draw.uniform(0.0, 8.0),
        turns=draw.uniform(0.0, 1.5),
        clockwise=draw.random() < 0.5,
        yaw_rad=draw.choice([None, 1.0]),
        axis=SpeedAxis.HORIZONTAL,
        speed_m_s=draw.uniform(1.0, 12.0),
        target=draw.randrange(-1, 9),
        repeats=draw.choice([-1, 0, 1, 2]),
        continues=draw.random() < 0.9,
    )


@pytest.mark.parametrize("flavour", Flavour)
@pytest.mark.parametrize("seed", range(12))
def test_random_missions(flavour: Flavour, seed: int) -> None:
    draw = random.Random(seed)  # noqa: S311 - a campaign, not cryptography
    vehicle = booted(flavour, seed=seed + 1, wind_m_s=draw.choice([0.0, 4.0]))
    autopilot = vehicle.autopilot
    first = (MissionItem(command=Command.WAYPOINT),) if flavour is Flavour.ARDUPILOT else ()
    up = MissionItem(command=Command.TAKEOFF, place=Place(*HOME, 8.0, Datum.HOME))

    def mission() -> tuple[MissionItem, ...]:
        return (*first, up, *(item(draw) for _ in range(draw.randrange(1, 9))))

    autopilot.load_mission(mission())
    if flavour is Flavour.ARDUPILOT:
        autopilot.set_mode(Mode.GUIDED)
        autopilot.arm()
    autopilot.start_mission()
    meddling = [
        lambda: autopilot.mission.set_current(draw.randrange(9)),
        lambda: autopilot.load_mission(mission()),
        lambda: autopilot.load_mission(()),
        lambda: autopilot.set_mode(draw.choice(list(autopilot.modes))),
        lambda: autopilot.set_mode(Mode.AUTO),
        autopilot.start_mission,
        autopilot.pause,
        autopilot.resume,
        autopilot.set_home,
    ]
    for _ in range(100):
        run(vehicle, 2.0)
        assert all(abs(speed) < 25.0 for speed in vehicle.truth.velocity_ned_m_s)
        assert len(autopilot.mission.news) <= 256
        if draw.random() < 0.25:
            draw.choice(meddling)()
