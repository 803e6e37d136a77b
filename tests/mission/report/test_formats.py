"""Pictures as PNG, SVG and PDF, the same bytes each time, and what mission they are of."""

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from mission.report.figures import PICTURES, save_simulated
from mission.report.figures.automaton import automaton
from mission.report.figures.canvas import WRITERS, about, abridged, text_size_em
from mission.report.figures.histories import time_histories, tracked_states
from mission.report.figures.paths import flown_path, planned_path
from mission.report.figures.simulated import true_path
from mission.simulate import simulate_plan
from tests.support.commands import MISSIONS, ran
from tests.support.drawn_plans import PAPER_TOUR, plan_of, record_of


def figures() -> list[Figure]:
    plan = plan_of(PAPER_TOUR)
    record, simulation = record_of(plan), simulate_plan(plan)
    planned = [draw(plan) for draw in (planned_path, automaton, time_histories)]
    return [*planned, tracked_states(plan, record), flown_path(plan, record), true_path(plan, simulation)]


def test_each_picture_says_the_mission_and_what_it_asks_for() -> None:
    for figure in figures():
        figure.draw_without_rendering()
        (words,) = [text for text in figure.texts if text.get_gid() == "about"]
        assert words.get_text() == "paper: F (S1 & F R) & G !K1"
        assert words.get_window_extent().y1 <= figure.texts[0].get_window_extent().y0
        for legend in figure.legends:
            assert legend.get_window_extent().y1 <= words.get_window_extent().y0


@pytest.mark.parametrize("text", ["F (a & F b) & " * 60, "x" * 900, "short", "ein Feld: " + "F (Süd-Wiese) " * 30])
def test_long_words_about_a_mission_are_cut_to_two_lines(text: str) -> None:
    text = text.strip()
    shown = abridged(text, 60.0, 2)
    assert all(text_size_em(line)[0] <= 60.0 for line in shown.split("\n"))
    assert shown.count("\n") <= 1
    assert shown.endswith(" …") == (shown.replace("\n", " ") != text)
    assert text.startswith(shown.removesuffix(" …").replace("\n", " "))


def test_a_mission_s_words_keep_within_the_picture() -> None:
    assert text_size_em(about(plan_of(PAPER_TOUR), 150.0))[0] * 9.0 <= 150.0


@pytest.mark.parametrize("name", WRITERS)
def test_the_same_picture_is_the_same_bytes_without_a_date(name: str) -> None:
    first, second = (WRITERS[name](time_histories(plan_of(PAPER_TOUR))) for _ in range(2))
    assert first == second
    assert not any(word in first for word in (b"CreationDate", b"<dc:date>", b"Matplotlib", b"tEXt"))


def test_each_command_draws_in_the_format_that_is_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mission = str(MISSIONS / "paper.yaml")
    assert ran(capsys, "plan", mission, "--pictures", str(tmp_path / "plan"), "--format", "svg").code == 0
    drawn = {path.name for path in (tmp_path / "plan").iterdir()}
    assert drawn < {Path(entry.picture.file).with_suffix(".svg").name for entry in PICTURES}
    assert len(drawn) == 6


def test_a_picture_is_written_in_each_format(tmp_path: Path) -> None:
    plan = plan_of(PAPER_TOUR)
    files = save_simulated(plan, simulate_plan(plan), tmp_path, ("png", "pdf"))
    assert sorted(files) == sorted(tmp_path.iterdir())
    assert [path.suffix for path in files] == [".png", ".pdf"] * 3
    assert {path.read_bytes()[:5] for path in files} == {b"\x89PNG\r", b"%PDF-"}
