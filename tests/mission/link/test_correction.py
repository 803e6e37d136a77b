"""The correction of setpoints: bounded whatever is reported, nothing without an error, and it lets go again."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.link.correction import FADING_S, MOST_LEAD_S, OFFSET_S, Correction
from mission.link.course import Reference
from tests.support.swinging import flown

REACH_M = 0.2
PERIOD_S = 0.1
STILL = (0.0, 0.0, 0.0)
AT_REST = Reference(STILL, STILL, STILL)
EASTWARDS = Reference(STILL, (4.0, 0.0, 0.0), STILL)
PLANNED = Reference((10.0, 20.0, 5.0), (3.0, -1.0, 0.0), (0.5, 0.2, 0.0))

vectors = st.tuples(*[st.floats(-40.0, 40.0)] * 3)
reports = st.lists(
    st.tuples(
        st.floats(-1.0, 2.0),
        st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0)),
        vectors,
        vectors,
        vectors,
        st.none() | st.tuples(*[st.floats(-1.2, 1.2)] * 3),
    ),
    max_size=80,
)


def observed(error_m: tuple[float, float], seconds: float, correction: Correction | None = None) -> Correction:
    """A correction that was told of the same error at 10 Hz, of a vehicle that was to stand still."""
    correction = correction or Correction(REACH_M)
    for tick in range(round(seconds / PERIOD_S) + 1):
        correction.observe(tick * PERIOD_S, error_m, AT_REST, STILL, None)
    return correction


@given(reports)
def test_it_never_reaches_beyond_its_bounds(told: list[tuple]) -> None:  # type: ignore[type-arg]
    correction, t_s = Correction(REACH_M), 0.0
    for step_s, error_m, planned, gained, moved, attitude in told:
        t_s += step_s
        correction.observe(t_s, error_m, Reference(STILL, planned, gained), moved, attitude)
        asked = correction.corrected(PLANNED)
        for axis in (0, 1):
            assert abs(asked.position_m[axis] - PLANNED.position_m[axis]) <= REACH_M + 1e-12
            assert abs(asked.velocity_m_s[axis] - PLANNED.velocity_m_s[axis]) <= 1.0 + 1e-12
            assert 0.0 <= correction.lead_s <= MOST_LEAD_S
            assert 0.0 <= correction.delay_s <= MOST_LEAD_S
            # Drag is made up for along the planned velocity only; beside that the velocity's error is damped.
            damping = max(-1.0, min(-correction.error_m_s[axis], 1.0))
            push = asked.acceleration_m_s2[axis] - PLANNED.acceleration_m_s2[axis] - damping
            assert -1e-12 <= push / PLANNED.velocity_m_s[axis] <= 2.0 + 1e-12
        assert (asked.position_m[2], asked.velocity_m_s[2], asked.acceleration_m_s2[2]) == (5.0, 0.0, 0.0)


def test_without_an_error_nothing_is_changed() -> None:
    correction = Correction(REACH_M)
    for tick in range(100):
        correction.observe(tick * PERIOD_S, (0.0, 0.0), PLANNED, PLANNED.velocity_m_s, (0.0, 0.0, 0.0))
    assert correction.corrected(PLANNED) == PLANNED


def test_the_error_of_the_velocity_is_damped_within_a_bound_and_less_on_a_late_link() -> None:
    correction = Correction(REACH_M)
    correction.observe(0.0, (0.1, 0.0), AT_REST, (0.4, -3.0, 0.0), None)
    assert correction.corrected(AT_REST).acceleration_m_s2 == pytest.approx((-0.4, 1.0, 0.0))
    pull_m_s = correction.corrected(AT_REST).velocity_m_s[0]
    correction.know_delay(1.2)
    assert correction.corrected(AT_REST).acceleration_m_s2[0] == pytest.approx(-0.1)
    assert correction.corrected(AT_REST).velocity_m_s[0] == pytest.approx(0.25 * pull_m_s)
    correction.rest()
    assert correction.corrected(AT_REST).acceleration_m_s2 == (0.0, 0.0, 0.0)


@given(st.floats(-3.0, 3.0))
def test_what_stays_is_taken_out_at_the_stated_pace(error_m: float) -> None:
    correction = observed((error_m, 0.0), 1.0)
    slowly = -error_m / OFFSET_S
    expected = max(-REACH_M, min(slowly, REACH_M))
    assert correction.offset_m[0] == pytest.approx(expected, rel=0.03)
    assert correction.offset_m[1] == 0.0


def test_a_long_error_winds_nothing_up() -> None:
    """After an hour at the bound it turns back as soon as the error does."""
    correction = observed((1.0, 0.0), 3600.0)
    assert correction.offset_m[0] == pytest.approx(-REACH_M)
    for tick in range(21):
        correction.observe(4000.0 + tick * PERIOD_S, (-1.0, 0.0), AT_REST, STILL, None)
    assert correction.offset_m[0] == pytest.approx(-REACH_M + 2.0 / OFFSET_S, abs=0.02)


def test_it_fades_when_nothing_asks_for_it() -> None:
    correction = observed((1.0, 0.0), 60.0)
    observed((0.0, 0.0), FADING_S, correction)
    assert correction.offset_m[0] == pytest.approx(-REACH_M * 0.368, rel=0.02)


@pytest.mark.parametrize("gap_s", [0.6, 30.0])
def test_across_a_gap_it_is_frozen(gap_s: float) -> None:
    correction = observed((1.0, 0.0), 1.0)
    before = correction.offset_m
    correction.observe(1.0 + gap_s, (1.0, 0.0), AT_REST, STILL, None)
    assert correction.offset_m == before


def test_far_from_the_path_it_is_frozen() -> None:
    """A position that leaps is no following error."""
    correction = observed((0.5, 0.0), 1.0)
    before = correction.offset_m
    observed((5.0, 0.0), 10.0, correction)
    assert correction.offset_m == before
    assert correction.corrected(PLANNED).velocity_m_s == PLANNED.velocity_m_s


def test_at_rest_only_what_was_learned_of_the_place_is_kept() -> None:
    correction = observed((0.5, 0.0), 1.0)
    correction.rest()
    asked = correction.corrected(PLANNED)
    assert asked.velocity_m_s == PLANNED.velocity_m_s
    assert asked.position_m[0] == PLANNED.position_m[0] + correction.offset_m[0]
    # And what comes after the rest is not taken for a report a moment later.
    before = correction.offset_m
    correction.observe(1.1, (0.5, 0.0), AT_REST, STILL, None)
    assert correction.offset_m == before


def test_what_the_vehicle_is_ahead_is_no_reason_to_wait() -> None:
    correction = Correction(REACH_M)
    correction.observe(0.0, (0.6, 0.1), EASTWARDS, STILL, None)
    assert correction.behind_m == pytest.approx(0.1)
    correction.observe(0.1, (-0.6, 0.1), EASTWARDS, STILL, None)
    assert correction.behind_m == pytest.approx(0.6)


@given(
    st.floats(0.3, 1.5),
    st.tuples(st.floats(-4.0, 4.0), st.floats(-4.0, 4.0)),
    st.tuples(st.floats(-8.0, 8.0), st.floats(-8.0, 8.0)),
)
def test_the_rate_is_the_largest_that_the_lean_allows(
    drag_per_s: float, wind_m_s: tuple[float, float], velocity_m_s: tuple[float, float]
) -> None:
    """Against k |s v - w| itself, for a vehicle that has swung to and fro in that wind."""
    correction = Correction(REACH_M)
    correction.drag = flown(drag_per_s, wind_m_s)
    planned = Reference((0.0, 0.0, 0.0), (*velocity_m_s, 0.0), STILL)

    def lean(rate: float) -> float:
        return drag_per_s * math.hypot(*(rate * v - w for v, w in zip(velocity_m_s, wind_m_s, strict=True)))

    rate = correction.rate_within(4.5, [planned])
    assert rate == 0.0 or lean(rate) <= 4.5 * 1.08 + 0.2
    if 0.0 < rate < 0.999:
        assert lean(rate) >= 4.5 * 0.92 - 0.2


@pytest.mark.parametrize(("delay_s", "most_s"), [(0.0, 0.2), (2.0, MOST_LEAD_S)])
def test_a_vehicle_that_seems_late_for_ever_is_led_by_no_more_than_tilting_and_the_link_take(
    delay_s: float, most_s: float
) -> None:
    correction = Correction(REACH_M)
    correction.know_delay(delay_s)
    for tick in range(1, 3000):
        planned = Reference(STILL, (2.0, 0.0, 0.0), (1.0, 0.0, 0.0))
        correction.observe(0.02 * tick, (0.0, 0.0), planned, (1.0, 0.0, 0.0), None)
    assert correction.lead_s == most_s


@pytest.mark.parametrize("delay_s", [0.0, 0.15, 0.3])
def test_the_lead_becomes_the_delay_by_which_the_velocity_comes(delay_s: float) -> None:
    """A vehicle whose velocity is what was asked for a while ago, on a way that swings; without delay there is none."""
    correction, asked = Correction(REACH_M), [0.0] * 1000
    correction.know_delay(delay_s)
    for tick in range(1, 12_000):
        t_s = 0.02 * tick
        planned = Reference(STILL, (2.0 * math.sin(t_s), 0.0, 0.0), (2.0 * math.cos(t_s), 0.0, 0.0))
        asked.append(2.0 * math.sin(t_s + correction.lead_s))
        flown = asked[-1 - round(delay_s / 0.02)]
        correction.observe(t_s, (0.0, 0.0), planned, (flown, 0.0, 0.0), None)
    assert correction.lead_s == pytest.approx(delay_s, abs=0.02)


@pytest.mark.parametrize("link_s", [0.0, 0.1, 0.25])
def test_the_position_is_asked_for_ahead_by_the_links_delay(link_s: float) -> None:
    """A vehicle that is, at a steady speed, where it was asked to be a while ago."""
    correction = Correction(REACH_M)
    for tick in range(3000):
        correction.observe(
            0.05 * tick, (4.0 * (correction.delay_s - link_s), 0.0), EASTWARDS, EASTWARDS.velocity_m_s, None
        )
    assert correction.delay_s == pytest.approx(link_s, abs=0.01)
