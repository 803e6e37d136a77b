"""``mission view``: where the page is said to be, what it shows, and how it ends."""

import webbrowser
from pathlib import Path
from urllib.request import urlopen

import pytest

from mission.cli import view
from mission.plan import plan_to_json
from tests.support.commands import MISSIONS, ran
from tests.support.drawn_plans import PAPER, PAPER_TOUR, flight_of, plan_of


@pytest.fixture
def seen(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """What whoever opens the page that is said is shown, before Ctrl-C."""
    pages: list[str] = []

    def look() -> None:
        said = capsys.readouterr().err
        [address] = [word for word in said.split() if word.startswith("http://127.0.0.1:")]
        with urlopen(address, timeout=20) as page:  # noqa: S310 - what was said above
            pages.append(page.read().decode())
        raise KeyboardInterrupt

    monkeypatch.setattr(view, "_wait", look)
    return pages


def test_a_plan_or_a_mission_is_shown_as_if_it_were_flown(
    seen: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = tmp_path / "plan.json"
    assert ran(capsys, "plan", str(MISSIONS / "paper.yaml"), "--out", str(plan)).code == 0
    assert ran(capsys, "view", str(plan)).code == 0
    assert ran(capsys, "view", str(MISSIONS / "paper.yaml")).code == 0
    for page in seen:
        assert 'data-shown="the plan, as if it were flown exactly"' in page
        assert "data-request" not in page
    assert len(seen) == 2


def test_a_flight_is_shown_by_its_folder_and_opened_where_that_is_asked_for(
    seen: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    plan, opened = plan_of(PAPER_TOUR), list[str]()
    folder = tmp_path / "paper-20250131-120000"
    folder.mkdir()
    (folder / "mission.yaml").write_bytes(PAPER)
    (folder / "plan.json").write_text(plan_to_json(plan))
    (folder / "record.jsonl").write_bytes(flight_of(plan)[0])
    monkeypatch.setattr(webbrowser, "open", opened.append)
    assert ran(capsys, "view", str(folder), "--open").code == 0
    assert 'data-shown="the flight of paper-20250131-120000"' in seen[0]
    assert opened[0].startswith("http://127.0.0.1:")


def test_what_is_no_flight_is_refused_as_elsewhere(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    refused = ran(capsys, "view", str(tmp_path))
    assert refused.code == 2
    assert "this is not the folder of a flight" in refused.err
    assert ran(capsys, "view", str(tmp_path / "none.yaml")).code == 2
