"""How a flight was made: each program that flew it, and hashes of its files as other programs compute them."""

import hashlib
import json
from pathlib import Path

import pytest

import mission
from mission.report.provenance import PROVENANCE_FILE, note_run, provenance_rows


def test_each_program_that_flies_a_flight_is_noted(tmp_path: Path) -> None:
    note_run(tmp_path, "mission fly a.yaml --seed 7", "7")
    note_run(tmp_path, "mission fly --resume a", None)
    first, second = json.loads((tmp_path / PROVENANCE_FILE).read_text())
    assert (first["command"], first["seed"], second["seed"]) == ("mission fly a.yaml --seed 7", "7", None)
    rows = provenance_rows(tmp_path)
    assert [value for name, value in rows if name == "Command"] == [
        "mission fly a.yaml --seed 7",
        "mission fly --resume a",
    ]
    assert any(name == "This report by" and mission.__version__ in value for name, value in rows)
    assert sum("numpy" in value for name, value in rows if name == "With") == 2


@pytest.mark.parametrize("text", ["", "{}", "[3]", "\udcff", "[" * 100_000], ids=lambda text: text[:9])
def test_what_is_damaged_tells_nothing(tmp_path: Path, text: str) -> None:
    (tmp_path / PROVENANCE_FILE).write_bytes(text.encode(errors="surrogateescape"))
    names = [name for name, _ in provenance_rows(tmp_path)]
    assert names == [f"SHA-256 of {PROVENANCE_FILE}", "This report by"]


def test_files_of_the_flight_are_known_by_their_hashes(tmp_path: Path) -> None:
    (tmp_path / "flight.tlog").write_bytes(b"abc")
    (tmp_path / "report.html").write_bytes(b"not of the flight")
    hashes = {name: value for name, value in provenance_rows(tmp_path) if name.startswith("SHA")}
    assert hashes == {"SHA-256 of flight.tlog": hashlib.sha256(b"abc").hexdigest()}
    assert hashes["SHA-256 of flight.tlog"].startswith("ba7816bf")
