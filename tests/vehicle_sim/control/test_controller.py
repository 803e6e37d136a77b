import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from tests.support.airframes import LIMITS, STEP_S, PerfectFlight, perfect
from tests.support.drawn_cases import tried
from vehicle_sim.control.controller import PX4_GAINS, TrackingGains, approach_speed, wrap
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.dynamics.hover import DRAG_PER_S
from vehicle_sim.signals import FREE, Guidance, Setpoint


class Flight(PerfectFlight):
    """The hover model under control, twenty metres up."""

    def __init__(self, gains: TrackingGains | None = None) -> None:
        super().__init__(Dynamics.HOVER, gains=gains)
        self.fly(Setpoint(position_ned_m=(0.0, 0.0, -20.0)), 20.0)


@tried(100)
@given(distance=st.floats(0.0, 1e4), gain=st.floats(0.1, 3.0), braking=st.floats(0.2, 10.0))
def test_approach_is_proportional_near_and_can_always_brake(distance: float, gain: float, braking: float) -> None:
    speed = approach_speed(distance, gain_per_s=gain, braking_m_s2=braking)
    assert speed <= gain * distance + 1e-9
    assert speed**2 <= 2.0 * braking * distance + 1e-9
    farther = approach_speed(distance + 1e-4, gain_per_s=gain, braking_m_s2=braking)
    assert 0.0 <= farther - speed <= gain * 1e-4 + 1e-9


@pytest.mark.parametrize("angle", [0.0, 1.0, -3.0, 3.2, 20.0, -50.0, np.pi, -np.pi])
def test_wrapped_angles_look_the_same_way(angle: float) -> None:
    assert -np.pi < wrap(angle) <= np.pi
    assert np.allclose((np.cos(wrap(angle)), np.sin(wrap(angle))), (np.cos(angle), np.sin(angle)))


@pytest.mark.parametrize("tau_s", [0.8, 1.5, pytest.param(5.0, marks=pytest.mark.long)])
def test_a_small_error_dies_out_critically_damped(tau_s: float) -> None:
    """The error of Eq. 12, in the limit where attitude is fast and nothing saturates; drag damps a little more."""
    flight = Flight(TrackingGains(tau_s=tau_s, observer_s=None))
    start = flight.fly(Setpoint(position_ned_m=(0.0, 0.0, -20.0)), 12.0 * tau_s)[-1].position_ned_m[0]
    motions = flight.fly(Setpoint(position_ned_m=(0.5, 0.0, -20.0)), 12.0 * tau_s)
    t = STEP_S * np.arange(1, len(motions) + 1)
    error = 0.5 - np.array([motion.position_ned_m[0] for motion in motions])
    error_dynamics = np.array([[0.0, 1.0], [-1.0 / tau_s**2, -2.0 / tau_s - DRAG_PER_S]])
    ideal = (0.5 - start) * np.array([expm(error_dynamics * moment)[0, 0] for moment in t])
    # Attitude lags by about 0.17 s; what that costs shrinks with the time constant.
    assert np.max(np.abs(error - ideal)) < 0.5 * 0.15 / tau_s
    assert error.min() > -0.5 * (0.05 if tau_s < 1.0 else 0.01)


@settings(max_examples=6, deadline=None)
@given(data=st.data(), tau_s=st.sampled_from([1.0, 2.0]))
def test_a_bounded_disturbance_leaves_a_bounded_error(data: st.DataObject, tau_s: float) -> None:
    """|d| <= w leaves |e| <= w tau^2 on each axis (the L1 norm of a critically damped second-order system)."""
    bound = 0.5
    flight = Flight(TrackingGains(tau_s=tau_s, observer_s=None))
    target = Setpoint(position_ned_m=(0.0, 0.0, -20.0), velocity_ned_m_s=(0.0, 0.0, 0.0))
    worst = np.zeros(2)
    for _ in range(15):
        push = data.draw(st.tuples(st.floats(-bound, bound), st.floats(-bound, bound)))
        flight.wind = (push[0] / DRAG_PER_S, push[1] / DRAG_PER_S, 0.0)
        for motion in flight.fly(target, data.draw(st.floats(0.2, 3.0))):
            worst = np.maximum(worst, np.abs(motion.position_ned_m[:2]))
    # Drag only helps; the lag of the attitude costs a few per cent.
    assert np.all(worst <= 1.05 * bound * tau_s**2)


def test_the_integral_learns_what_lasts_and_no_more() -> None:
    """PX4's gains: a steady push is taken out in seconds, by an integral that is then as large as the push."""
    flight = Flight(PX4_GAINS)
    flight.wind = (8.0, -4.0, 0.0)
    flight.fly(Setpoint(position_ned_m=(0.0, 0.0, -20.0), velocity_ned_m_s=(0.0, 0.0, 0.0)), 40.0)
    assert flight.airframe.motion.position_ned_m[:2] == pytest.approx((0.0, 0.0), abs=0.01)
    assert flight.controller.disturbance_ned_m_s2[:2] == pytest.approx((8.0 * DRAG_PER_S, -4.0 * DRAG_PER_S), abs=0.02)


def test_the_observer_takes_out_what_lasts() -> None:
    bare, watched = Flight(TrackingGains(observer_s=None)), Flight()
    target = Setpoint(position_ned_m=(0.0, 0.0, -20.0))
    for flight in (bare, watched):
        flight.wind = (8.0, 0.0, 0.0)
        flight.fly(target, 20.0)
    assert bare.airframe.motion.position_ned_m[0] == pytest.approx(8.0 * DRAG_PER_S * 0.8**2, rel=0.15)
    assert abs(watched.airframe.motion.position_ned_m[0]) < 0.01
    assert watched.controller.disturbance_ned_m_s2[0] == pytest.approx(8.0 * DRAG_PER_S, abs=0.02)


@pytest.mark.parametrize("distance_m", [2.0, 10.0, 60.0])
def test_a_step_of_position_is_flown_without_overshoot_and_within_limits(distance_m: float) -> None:
    flight = Flight()
    motions = flight.fly(Setpoint(position_ned_m=(distance_m, 0.0, -20.0)), 6.0 + distance_m / 2.0)
    north = np.array([motion.position_ned_m[0] for motion in motions])
    assert north.max() < distance_m * 1.01 + 0.02
    assert north[-1] == pytest.approx(distance_m, abs=0.05)
    assert max(np.hypot(*motion.velocity_ned_m_s[:2]) for motion in motions) < LIMITS.speed_m_s * 1.05
    assert max(np.hypot(motion.roll_rad, motion.pitch_rad) for motion in motions) < LIMITS.tilt_rad * 1.1


def test_climb_and_descent_keep_their_speeds() -> None:
    flight = Flight()
    up = flight.fly(Setpoint(position_ned_m=(0.0, 0.0, -40.0)), 15.0)
    down = flight.fly(Setpoint(position_ned_m=(0.0, 0.0, -20.0)), 20.0)
    assert min(motion.velocity_ned_m_s[2] for motion in up) == pytest.approx(-LIMITS.climb_m_s, abs=0.1)
    assert max(motion.velocity_ned_m_s[2] for motion in down) == pytest.approx(LIMITS.descent_m_s, abs=0.1)
    assert down[-1].position_ned_m[2] == pytest.approx(-20.0, abs=0.1)


def test_velocity_alone_is_held_and_free_axes_are_left_free() -> None:
    flight = Flight()
    motions = flight.fly(Setpoint(position_ned_m=(None, None, -20.0), velocity_ned_m_s=(2.0, -1.0, None)), 10.0)
    assert np.allclose(motions[-1].velocity_ned_m_s[:2], (2.0, -1.0), atol=0.02)
    flight.wind = (5.0, 0.0, 0.0)
    motions = flight.fly(Setpoint(position_ned_m=(None, None, -20.0)), 20.0)
    assert abs(motions[-1].pitch_rad) < 0.01
    assert motions[-1].velocity_ned_m_s[0] > 3.0


def test_acceleration_alone_is_flown() -> None:
    flight = Flight()
    setpoint = Setpoint(position_ned_m=(None, None, -20.0), acceleration_ned_m_s2=(0.5, 0.0, None))
    motions = flight.fly(setpoint, 3.0)
    assert motions[-1].acceleration_ned_m_s2[0] == pytest.approx(0.5, abs=0.06)


def test_feed_forward_lets_a_circle_be_tracked_closely() -> None:
    radius_m, rate_rad_s = 6.0, 0.35

    def rms(*, with_acceleration: bool) -> float:
        flight, errors = Flight(), []
        for step in range(3000):
            angle = rate_rad_s * step * STEP_S
            c, s = radius_m * np.cos(angle), radius_m * np.sin(angle)
            pull = (-(rate_rad_s**2) * c, -(rate_rad_s**2) * s, 0.0)
            motion = flight.fly(
                Setpoint(
                    position_ned_m=(c - radius_m, s, -20.0),
                    velocity_ned_m_s=(-rate_rad_s * s, rate_rad_s * c, 0.0),
                    acceleration_ned_m_s2=pull if with_acceleration else FREE,
                ),
                STEP_S,
            )[-1]
            if step > 1000:
                errors.append(np.hypot(motion.position_ned_m[0] - c + radius_m, motion.position_ned_m[1] - s))
        return float(np.sqrt(np.mean(np.square(errors))))

    # ArduCopter: 0.6 m with position and velocity, 0.25 m with acceleration too.
    assert rms(with_acceleration=False) == pytest.approx(0.5, abs=0.15)
    assert rms(with_acceleration=True) < 0.15


@pytest.mark.parametrize("target", [1.0, -2.5, 3.1])
def test_yaw_turns_the_short_way_and_keeps_its_rate(target: float) -> None:
    flight = Flight()
    motions = flight.fly(Setpoint(position_ned_m=(0.0, 0.0, -20.0), yaw_rad=target), 8.0)
    assert motions[-1].yaw_rad == pytest.approx(target, abs=0.02)
    assert max(abs(motion.rates_rad_s[2]) for motion in motions) < LIMITS.yaw_rate_rad_s * 1.05
    assert np.hypot(*motions[-1].position_ned_m[:2]) < 0.02


def test_a_yaw_rate_is_kept_up() -> None:
    flight = Flight()
    before = flight.airframe.motion.yaw_rad
    motions = flight.fly(Setpoint(position_ned_m=(0.0, 0.0, -20.0), yaw_rate_rad_s=0.3), 6.0)
    assert motions[-1].rates_rad_s[2] == pytest.approx(0.3, abs=0.01)
    assert motions[-1].yaw_rad - before == pytest.approx(1.8, abs=0.2)


def test_idle_guidance_stops_the_motors() -> None:
    flight = Flight()
    command = flight.controller.step(perfect(flight.airframe.motion), Guidance(None, LIMITS))
    assert command.thrust_m_s2 == 0.0
