"""Patches of curves against the curves themselves, and time laws against many instants of them."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.spec.model import Extension
from mission.steering.bezier import BezierCurve
from mission.steering.grid import Limits
from mission.steering.joined import Curve, JoinedCurve
from mission.steering.rounded import RoundedPolyline
from mission.steering.smoothing import FourierCurve
from mission.steering.timing import time_law
from mission.verify.plans.motion import Law, excess, motion_of
from mission.verify.plans.patches import Patches, patches_of
from tests.support.drawn_cases import tried

WAY = RoundedPolyline(
    np.array([(0.0, 0.0), (20.0, 0.0), (20.0, 9.0), (4.0, 9.0), (4.0, 9.5)]), np.array([3.0, 4.5, 0.25]), 2.0
)


def straight(begin: FloatArray, end: FloatArray) -> RoundedPolyline:
    return RoundedPolyline(np.array([begin, end]), np.empty(0), 2.0)


def wave(seed: int, waves: int, extension: Extension) -> FourierCurve:
    random = np.random.default_rng(seed)
    slope = random.normal(size=2) if extension is Extension.ODD else np.zeros(2)
    amplitudes = random.normal(size=(waves, 2)) / np.arange(1, waves + 1)[:, None] ** 2 * 5.0
    return FourierCurve(extension, 30.0, random.normal(size=2) * 50.0, slope, amplitudes)


def spline(seed: int, pieces: int) -> BezierCurve:
    """Pieces of one second whose ends continue each other up to the second derivative."""
    random = np.random.default_rng(seed)
    controls = random.normal(size=(pieces, 6, 2)).cumsum(axis=1)
    for before, after in pairwise(controls):
        after[0] = before[5]
        after[1] = 2.0 * before[5] - before[4]
        after[2] = 4.0 * before[5] - 4.0 * before[4] + before[3]
    return BezierCurve(np.arange(pieces + 1.0), controls)


CURVES: dict[str, Curve] = {
    "cosines": wave(1, 12, Extension.EVEN),
    "sines": wave(2, 40, Extension.ODD),
    "polyline": WAY,
    "spline": spline(3, 6),
}


def values(control: FloatArray, u: FloatArray) -> FloatArray:
    """The polynomials with these control points, (K, n, 2), at shares u (P,) of each, by their definition."""
    here = np.broadcast_to(control[:, None], (len(control), len(u), *control.shape[1:]))
    while here.shape[2] > 1:
        here = here[:, :, :-1] * (1.0 - u[:, None, None]) + here[:, :, 1:] * u[:, None, None]
    return np.asarray(here[:, :, 0])


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("cut", [False, True])
def test_patches_are_the_curve_within_what_they_say(name: str, cut: bool) -> None:  # noqa: FBT001 - a table's column
    curve = CURVES[name]
    patches = patches_of(curve.to_json())
    if cut:
        patches = patches.cut(np.linspace(-1.0, curve.duration_s + 1.0, 57)).halves()
    assert patches.begins_s[0] == 0.0
    assert patches.ends_s[-1] == pytest.approx(curve.duration_s, abs=1e-9)
    u = np.linspace(0.05, 0.95, 7)
    s = patches.begins_s[:, None] + (patches.ends_s - patches.begins_s)[:, None] * u
    for order, due in enumerate(curve.jet(s.ravel())):
        found = values(patches.derivative(order), u)
        off = np.abs(found - due.reshape(found.shape)).max(axis=(1, 2))
        assert (off <= patches.off[:, order] + 1e-7 * order * (1.0 + np.abs(due).max())).all()
    np.testing.assert_allclose(patches.at(s.ravel()), curve.position(s.ravel()), atol=1e-7)


@pytest.mark.parametrize("name", CURVES)
def test_smooth_curves_have_no_jumps_and_joined_ones_have_them_where_they_join(name: str) -> None:
    curve = CURVES[name]
    assert not len(patches_of(curve.to_json()).jumps_s)
    end = curve.position([curve.duration_s])[0]
    joined = JoinedCurve((curve, straight(end, end + np.array([3.0, 40.0]))))
    np.testing.assert_allclose(patches_of(joined.to_json()).jumps_s, [curve.duration_s])
    broken = {"kind": "joined", "legs": [curve.to_json(), straight(end + 0.01, end + 3.0).to_json()]}
    with pytest.raises(ValueError, match="broken"):
        _ = patches_of(broken).jumps_s


def written(curve: Curve) -> Law:
    law = time_law(curve, Limits(6.0, 2.5, 4.0), holds=((5.0, 2.0),))
    return Law(law.to_json())


@pytest.mark.parametrize("name", CURVES)
def test_a_law_keeps_the_limits_it_was_made_for_and_no_tighter_ones(name: str) -> None:
    curve = CURVES[name]
    law, patches = written(curve), patches_of(curve.to_json())
    assert law.fault is None
    assert excess(motion_of(patches, law), (6.0, 2.5, 4.0)) is None
    assert any(s == pytest.approx(5.0) and seconds >= 2.0 - 1e-9 for s, seconds in law.rests())
    speed, bent, shaken = flown(law, curve)
    assert excess(motion_of(patches, law), (speed + 1e-3, bent * 1.6 + 0.1, 4.0)) is None
    assert "m/s at" in str(excess(motion_of(patches, law), (speed * 0.999, 100.0, 100.0)))
    assert "m/s^2 at" in str(excess(motion_of(patches, law), (100.0, bent * 0.999, 100.0)))
    assert "m/s^3 at" in str(excess(motion_of(patches, law), (100.0, 100.0, shaken * 0.99)))


def flown(law: Law, curve: Curve) -> tuple[float, float, float]:
    """The largest speed, acceleration and change of the acceleration at many instants."""
    t = np.linspace(0.0, law.duration_s, 20_001)
    s, rate, growth, _ = law.jet(t)
    _, slope, bend = curve.jet(np.clip(s, 0.0, curve.duration_s))
    velocity, acceleration = slope * rate[:, None], bend * rate[:, None] ** 2 + slope * growth[:, None]
    changes = np.diff(acceleration, axis=0) / np.diff(t)[:, None]
    speed, bent, shaken = (float(np.hypot(*values.T).max()) for values in (velocity, acceleration, changes))
    return speed, bent, shaken


@given(st.integers(0, 10_000), st.integers(1, 30))
@tried(8)
def test_the_bounds_of_a_law_hold_at_every_instant(seed: int, waves: int) -> None:
    curve = wave(seed, waves, Extension.ODD)
    law, patches = written(curve), patches_of(curve.to_json())
    speed, bent, shaken = flown(law, curve)
    assert excess(motion_of(patches, law), (speed * (1.0 - 1e-4), 100.0, 100.0)) is not None
    assert excess(motion_of(patches, law), (100.0, bent * (1.0 - 1e-4), 100.0)) is not None
    assert excess(motion_of(patches, law), (100.0, 100.0, shaken * (1.0 - 1e-4))) is not None


@pytest.mark.parametrize("name", CURVES)
def test_a_motion_is_that_of_the_curve_by_its_law(name: str) -> None:
    curve = CURVES[name]
    law, patches = written(curve), patches_of(curve.to_json())
    motion, u = motion_of(patches, law, np.linspace(0.0, curve.duration_s, 9)).halves(), np.linspace(0.1, 0.9, 3)
    t = motion.begins_s[:, None] + (motion.ends_s - motion.begins_s)[:, None] * u
    s, rate, growth, _ = (each[:, None] for each in law.jet(t.ravel()))
    place, slope, bend = curve.jet(np.clip(s[:, 0], 0.0, curve.duration_s))
    due = place, slope * rate, bend * rate**2 + slope * growth
    for found, each in zip((motion.place, motion.velocity, motion.acceleration), due, strict=True):
        np.testing.assert_allclose(values(found, u).reshape(-1, 2), each, atol=2e-6)
    change = np.diff(values(motion.acceleration, np.array([0.0, 1.0])), axis=1)[:, 0]
    jerk = values(motion.jerk, np.linspace(0.0, 1.0, 33)).mean(axis=1) * (motion.ends_s - motion.begins_s)[:, None]
    np.testing.assert_allclose(jerk, change, atol=0.02)


def test_a_broken_law_is_told() -> None:
    good = time_law(WAY, Limits(6.0, 2.5, 4.0)).to_json()
    for key, number, shift in (("rates", 9, 0.1), ("knots_s", 7, 1e-3), ("rates", 0, 0.1), ("growths", 5, 1e-4)):
        data = {name: list(value) if isinstance(value, list) else value for name, value in good.items()}
        data[key][number] += shift
        assert Law(data).fault is not None
    for rate, fault in ((0.2, "it runs backwards, at 0.000 s"), (0.25, None)):  # with a dip of 0.25
        dip = {"knots_t_s": [0.0, 1.0], "knots_s": [0.0, rate - 1.0 / 6.0], "rates": [rate] * 2, "growths": [-1.0, 1.0]}
        assert Law(dip).fault == fault
    with pytest.raises(ValueError, match="knots in the order of time"):
        Law({**good, "growths": [0.0]})


def test_a_patch_that_is_cut_lies_in_the_hull_of_the_whole() -> None:
    whole = patches_of(CURVES["spline"].to_json())
    parts: Patches = whole.cut(np.linspace(0.0, 6.0, 61))
    for part, begin in zip(parts.control_m, parts.begins_s.tolist(), strict=True):
        around = whole.control_m[int(begin + 1e-9)]
        for angle in np.linspace(0.0, np.pi, 9):
            way = np.array([np.cos(angle), np.sin(angle)])
            low, high = (around @ way).min() - 1e-9, (around @ way).max() + 1e-9
            assert low <= (part @ way).min() <= (part @ way).max() <= high
