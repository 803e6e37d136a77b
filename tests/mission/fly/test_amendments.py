"""Changes that are handed in through a flight's folder are taken once, whoever dies in between."""

import time
from argparse import Namespace
from pathlib import Path

import pytest

from mission.cli.amend import run
from mission.errors import LinkError, RecordError
from mission.fly.amendments import AmendmentAnswer, AmendmentFolder, answer_to, hand_in
from mission.report.reading import read_record
from mission.report.record import FlightRecord


def test_a_flight_that_is_taken_up_takes_no_change_again(tmp_path: Path) -> None:
    name = hand_in(tmp_path, lines=["drop pond"])
    folder = AmendmentFolder(tmp_path)
    taken = folder.take()
    assert taken is not None
    assert taken.lines == ("drop pond",)
    folder.answer(taken, AmendmentAnswer(accepted=True, words="another plan is flown"))
    waiting = hand_in(tmp_path, lines=["laps 3"])
    again = AmendmentFolder(tmp_path)
    left = again.take()
    assert left is not None
    assert left.name == waiting
    assert again.take() is None
    answer = answer_to(tmp_path, name)
    assert answer is not None
    assert answer.accepted


def test_a_change_that_nobody_waits_for_any_more_is_withdrawn(tmp_path: Path) -> None:
    mission = tmp_path / "other.yaml"
    mission.write_text("name: other")
    with FlightRecord.in_folder(tmp_path, "silent") as record:
        assert record.folder is not None
        with pytest.raises(LinkError, match=r"is the one of .* over"):
            run(Namespace(folder=str(record.folder), file=str(mission), within=0.02))
        assert AmendmentFolder(record.folder).take() is None


def test_one_for_a_flight_that_is_over_is_told_so_at_once(tmp_path: Path) -> None:
    mission = tmp_path / "other.yaml"
    mission.write_text("name: other")
    with FlightRecord.in_folder(tmp_path, "flown") as record:
        assert record.folder is not None
    began_s = time.monotonic()
    with pytest.raises(LinkError, match="its flight is over"):
        run(Namespace(folder=str(record.folder), file=str(mission), within=60.0))
    assert time.monotonic() - began_s < 30.0
    assert AmendmentFolder(record.folder).take() is None
    size = read_record(record.folder).size
    with FlightRecord.reopened(record.folder, "flown", size) as again:  # whoever asked has let go of it
        again.write("event", None, name="flown on")
    with pytest.raises(RecordError, match="since it was read"):
        FlightRecord.reopened(record.folder, "flown", size)


def test_of_many_changes_at_once_those_that_came_last_are_refused(tmp_path: Path) -> None:
    names = [hand_in(tmp_path, lines=[f"laps {number}"]) for number in range(100)]
    folder, taken = AmendmentFolder(tmp_path), []
    while (change := folder.take()) is not None:
        taken.append(change.name)
    assert taken == names[:8]
    for name in names[8:]:
        answer = answer_to(tmp_path, name)
        assert answer is not None
        assert not answer.accepted
        assert "hand it in again" in answer.words


def test_a_change_in_no_letters_is_no_end_of_a_flight(tmp_path: Path) -> None:
    (tmp_path / "0.amendment.json").write_text('{"mission": "\\ud800"}')
    (tmp_path / "1.amendment.json").write_text("[" * 100_000)
    folder = AmendmentFolder(tmp_path)
    taken = folder.take()
    assert taken is not None
    assert taken.mission
    assert folder.take() is None
    answer = answer_to(tmp_path, "1")
    assert answer is not None
    assert "cannot be read" in answer.words
