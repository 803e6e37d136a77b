"""Noisy signals in pictures: the band holds every sample, the line is where the signal is, and gaps stay gaps."""

import numpy as np
import pytest

from mission.geometry.arrays import FloatArray
from mission.report.figures.filtering import filtered, round_number, time_constant
from mission.report.figures.histories import control_signals, tracked_states
from mission.report.reading import parse_record
from tests.support.drawn_plans import PAPER_TOUR, flight_of, plan_of

T_S = np.arange(0.0, 100.0, 0.02)


def noise(seed: int = 3) -> FloatArray:
    return np.random.default_rng(seed).normal(0.0, 1.0, len(T_S))


def test_the_band_holds_every_sample() -> None:
    values = noise()
    seen = filtered(T_S, values, 0.5)
    inside = (seen.t_s[0] <= T_S) & (seen.t_s[-1] >= T_S)
    assert np.all(values[inside] >= np.interp(T_S[inside], seen.t_s, seen.low))
    assert np.all(values[inside] <= np.interp(T_S[inside], seen.t_s, seen.high))
    assert np.all((seen.low <= seen.line) & (seen.line <= seen.high))


def test_the_line_is_a_low_pass_that_is_not_late() -> None:
    constant_s, period_s = 0.5, 10.0
    wave = np.sin(2 * np.pi * T_S / period_s)
    seen = filtered(T_S, wave, constant_s)
    middle = (seen.t_s > 10.0) & (seen.t_s < 90.0)
    gain = 1.0 / (1.0 + (2 * np.pi * constant_s / period_s) ** 2)  # of two first-order low-passes
    np.testing.assert_allclose(seen.line[middle], gain * np.sin(2 * np.pi * seen.t_s[middle] / period_s), atol=0.005)
    assert np.std(filtered(T_S, noise(), constant_s).line) < 0.2


def test_a_gap_is_left_open_and_what_is_not_a_number_is_no_sample() -> None:
    values = np.where((T_S > 40.0) & (T_S < 60.0), np.nan, 1.0)
    seen = filtered(T_S, values, 0.5)
    assert np.isnan(seen.line[(seen.t_s > 41.0) & (seen.t_s < 59.0)]).all()
    assert np.allclose(seen.line[(seen.t_s < 40.0) | (seen.t_s > 60.0)], 1.0)
    assert len(filtered(np.zeros(0), np.zeros(0), 1.0).t_s) == 0
    assert len(filtered(T_S, np.full(len(T_S), np.nan), 1.0).t_s) == 0


@pytest.mark.parametrize(("until_s", "every_s", "constant_s"), [(843, 0.02, 2), (81, 0.05, 0.2), (80, 1, 2), (0, 1, 1)])
def test_the_time_constant_is_round_and_fits_the_picture_and_the_samples(
    until_s: float, every_s: float, constant_s: float
) -> None:
    assert time_constant(np.arange(0.0, until_s, every_s)) == constant_s


def test_round_numbers() -> None:
    assert [round_number(x) for x in (0.3, 1.0, 4.9, 5.0, 99.0)] == pytest.approx([0.2, 1, 2, 5, 50])


def test_pictures_name_the_filter_and_show_the_control_under_its_noise() -> None:
    plan = plan_of(PAPER_TOUR)
    reports = 2000
    error_m = 0.03 * np.random.default_rng(1).normal(size=(reports, 2))
    record = parse_record(flight_of(plan, error_m=error_m, reports=reports)[0])
    for figure in (tracked_states(plan, record), control_signals(plan, record)):
        (legend,) = figure.legends
        labels = [text.get_text() for text in legend.get_texts()]
        assert any("low-pass τ = 2 s" in label for label in labels)
        assert "least to greatest" in labels
        assert any("first-order low-pass of 2 s" in text.get_text() for text in figure.texts)
    axes = tracked_states(plan, record).axes[4]
    (line,) = [drawn for drawn in axes.lines if drawn.get_gid() == "error"]
    (band,) = [drawn for drawn in axes.collections if drawn.get_gid() == "error band"]
    drawn = np.asarray(line.get_ydata(), dtype=np.float64)
    assert np.nanmax(np.abs(drawn)) < np.abs(error_m).max()
    assert band.get_datalim(axes.transData).height > 2 * np.ptp(drawn[np.isfinite(drawn)])
