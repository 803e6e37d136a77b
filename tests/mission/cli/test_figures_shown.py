"""The figures of a flight on the terminal: what is known, as much as there is room for, never more than a line."""

import io
from dataclasses import replace

import pytest
from rich.cells import cell_len
from rich.console import Console

from mission.cli import live
from mission.cli.live import Display, Part, figures, fitted
from mission.fly import Progress
from mission.fly.nearness import Nearness
from mission.monitor.stage import Stage
from mission.monitor.time_bounds import BoundNow
from mission.monitor.verdict import Verdict
from tests.support.small_missions import SMALL, plan_of

FLYING = Progress(
    stage=Stage.FLY,
    waiting_for="",
    t_s=40.0,
    trajectory_s=20.0,
    duration_s=90.0,
    leg=3,
    legs=20,
    done=1,
    total=2,
    awaited=("goal",),
    laps=0,
    laps_asked=None,
    returning=False,
    verdict=Verdict.OPEN,
    altitude_m=6.04,
    speed_m_s=2.15,
    error_m=0.123,
    battery_percent=87.0,
    nearest=("pond {1}", 12.34),
)
ALL = "6.0 m high · 2.1 m/s · error 0.12 m · battery 87 % · 12.3 m from pond {1}"
ON_GROUND = Progress(
    Stage.CONNECT, "", None, 0.0, 90.0, 0, 20, 0, 2, (), laps=0, laps_asked=None, returning=False, verdict=Verdict.OPEN
)


@pytest.mark.parametrize(
    ("width", "shown"),
    [
        (len(ALL), ALL),
        (len(ALL) - 1, ALL.replace("2.1 m/s · ", "")),
        (45, "battery 87 % · 12.3 m from pond {1}"),
        (20, "12.3 m from pond {1}"),
        (5, "12.3 m from pond {1}"),
    ],
)
def test_parts_are_left_out_where_there_is_no_room(width: int, shown: str) -> None:
    assert fitted(figures(FLYING), width) == shown


def test_what_is_not_known_is_not_shown() -> None:
    assert figures(ON_GROUND) == []
    assert fitted([], 80) == ""


def test_what_would_move_the_cursor_shows_its_code_which_counts() -> None:
    parts = [Part("a\x1b[2J", 0), Part("b", 1)]
    assert [fitted(parts, width) for width in (12, 11)] == ["a\\x1b[2J · b", "a\\x1b[2J"]


@pytest.mark.parametrize("width", [30, 46, 59, 99, 100, 160])
def test_a_flight_is_two_lines_at_any_width(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    screen = io.StringIO()
    console = Console(file=screen, force_terminal=True, width=width, color_system=None, legacy_windows=False)
    monkeypatch.setattr(live, "err", console)
    display = Display(plan_of(SMALL))
    display.show(FLYING)
    lines = console.render_lines(display._bar.get_renderable(), pad=False)
    shown = ["".join(segment.text for segment in line).rstrip() for line in lines]
    assert len(shown) == 2
    assert all(cell_len(line) <= width - 3 for line in shown)  # what is typed, such as ^C, has room at the end
    assert "70 s left" in shown[0]
    assert "12.3 m from pond {1}" in shown[1]
    assert ("error 0.12 m" in shown[1]) == (width >= 59)


def test_the_nearest_restricted_region_is_told_by_its_drawn_shape() -> None:
    plan, nearness = plan_of(SMALL), Nearness()
    assert nearness.of(plan, (9.0, 8.0)) == ("pond", 14.0)
    assert nearness.of(plan, (10.0, 25.0)) == ("pond", 0.0)
    assert nearness.of(plan, (float("nan"), 0.0)) is None
    assert nearness.of(plan_of(SMALL.replace("kind: restricted", "kind: area")), plan.start_m) is None


def test_the_bar_tells_what_is_open_and_what_was_missed_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = io.StringIO()
    console = Console(file=screen, force_terminal=True, width=200, color_system=None, legacy_windows=False)
    monkeypatch.setattr(live, "err", console)
    display = Display(plan_of(SMALL))
    bounds = (
        BoundNow("F[0,9] home", met=True, at_s=0.0),
        BoundNow("F[0,60] goal", met=None, at_s=60.0, will=False),
        BoundNow("G[0,15] !pond", met=False, at_s=12.3),
    )
    display.show(replace(FLYING, bounds=bounds, since_s=20.0))
    lines = console.render_lines(display._bar.get_renderable(), pad=False)
    shown = "".join(segment.text for segment in lines[0])
    assert "F[0,60] goal open, 40 s left · G[0,15] !pond missed at 12.3 s" in shown
    assert "F[0,9] home" not in shown
