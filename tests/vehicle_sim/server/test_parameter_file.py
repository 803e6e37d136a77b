"""Parameters in a file: read at the start, written whole, with the line of each fault."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.drawn_cases import tried
from vehicle_sim import cli
from vehicle_sim.cli.command_line import build_parser
from vehicle_sim.errors import ConfigurationError, ParameterError
from vehicle_sim.parameters import Flavour, ParameterStore, default_parameters
from vehicle_sim.parameters.file import as_text, take_text
from vehicle_sim.server.parameter_file import keep_parameters, load_parameters, save_parameters

BOTH = pytest.mark.parametrize("flavour", Flavour)


def values(store: ParameterStore) -> dict[str, float]:
    return {name: store.stored(name) for name in store}


@given(st.sampled_from(Flavour), st.data())
def test_what_is_written_is_read_back_bit_by_bit(flavour: Flavour, data: st.DataObject) -> None:
    store = default_parameters(flavour)
    for name in data.draw(st.lists(st.sampled_from(store.names), max_size=8)):
        definition = store.definition(name)
        least, most = definition.kind.limits
        if not definition.read_only:
            store.set(name, data.draw(st.floats(least, most)))
    again = default_parameters(flavour)
    take_text(again, as_text(store))
    assert values(again) == values(store)


@BOTH
def test_a_person_can_read_it(flavour: Flavour) -> None:
    store = default_parameters(flavour)
    lines = as_text(store).splitlines()
    assert flavour.value in lines[0]
    lines[1:] = [line.removeprefix("# ") for line in lines[1:]]  # facts are remarks
    assert [line.split()[0] for line in lines[1:]] == list(store.names)
    for line, name in zip(lines[1:], store.names, strict=True):
        assert float(line.split()[1]) == pytest.approx(store[name])
        assert line.partition(" # ")[2].removeprefix("fact: ") == store.definition(name).meaning


@pytest.mark.parametrize(
    "line", ["WPNAV_SPEED 500", "WPNAV_SPEED,500", "  WPNAV_SPEED\t500.0 # slow", "WPNAV_SPEED 5e2"]
)
def test_the_forms_that_other_programs_write(line: str) -> None:
    store = default_parameters(Flavour.ARDUPILOT)
    take_text(store, f"# a remark\n\n{line}\r\n")
    assert store["WPNAV_SPEED"] == 500.0


def test_files_of_older_versions_are_read() -> None:
    store = default_parameters(Flavour.ARDUPILOT)
    take_text(store, "ARMING_DELAY_SEC 2 # gone\nARMING_SKIPCHK 0\nWPNAV_SPEED 5000\n")
    assert (store.stored("WPNAV_SPEED"), store["WPNAV_SPEED"]) == (5000.0, 2000.0)
    store = default_parameters(Flavour.PX4)
    take_text(store, "MPC_HOLD_DZ 0.2\nSYS_AUTOSTART 4001\n")
    assert store["MAN_DEADZONE"] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("WPNAV_SPEED 500\nWPNAV_SPED 500", r"line 2: there is no parameter 'WPNAV_SPED'; is WPNAV_SPEED meant\?"),
        ("wpnav_speed 500", "is WPNAV_SPEED meant"),
        ("WPNAV_SPEED", "line 1: write NAME VALUE"),
        ("WPNAV_SPEED 1 2", "line 1: write NAME VALUE"),
        ("WPNAV_SPEED fast", "takes a number, not 'fast'"),
        ("WPNAV_SPEED nan", "finite"),
        ("\n\nFS_GCS_ENABLE 1.5", "line 3: FS_GCS_ENABLE takes a whole number"),
        ("FS_GCS_ENABLE inf", "line 1"),
        ("FRAME_CLASS 2", "is a fact about the vehicle: it is 1"),
        ("RTL_ALT 1000\nRTL_ALT 1000", "line 2: RTL_ALT stands in line 1 already"),
        ("\x00", "line 1"),
    ],
)
def test_faults_name_their_line(text: str, said: str) -> None:
    with pytest.raises(ParameterError, match=said):
        take_text(default_parameters(Flavour.ARDUPILOT), text)


@tried(50)
@given(st.text(max_size=60))
def test_any_text_is_taken_or_refused_and_never_worse(text: str) -> None:
    store = default_parameters(Flavour.PX4)
    try:
        take_text(store, text)
    except ParameterError as error:
        assert "line " in str(error)  # noqa: PT017 - either outcome is right


def test_every_change_is_kept_and_no_rest_is_left(tmp_path: Path) -> None:
    path, store = tmp_path / "quad.parm", default_parameters(Flavour.PX4)
    said: list[str] = []
    load_parameters(path, store)  # the first start: there is no file yet
    keep_parameters(path, store, said.append)
    store.set("MPC_XY_CRUISE", 7.5)
    again = default_parameters(Flavour.PX4)
    load_parameters(path, again)
    assert values(again) == values(store)
    written = path.stat().st_mtime_ns
    store.set("MPC_XY_CRUISE", 7.5)
    assert path.stat().st_mtime_ns == written
    assert [file.name for file in tmp_path.iterdir()] == ["quad.parm"]
    assert said == []


def test_a_folder_that_goes_away_is_told_and_the_vehicle_flies_on(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    said: list[str] = []
    store = default_parameters(Flavour.PX4)
    keep_parameters(folder / "quad.parm", store, said.append)
    (folder / "quad.parm").unlink()
    folder.rmdir()
    assert store.set("MPC_XY_CRUISE", 7.5) == 7.5
    (sentence,) = said
    assert "not kept" in sentence


def test_files_that_are_none(tmp_path: Path) -> None:
    store, path = default_parameters(Flavour.PX4), tmp_path / "file"
    with pytest.raises(ConfigurationError):
        load_parameters(tmp_path, store)
    with pytest.raises(ConfigurationError):
        save_parameters(tmp_path / "no" / "folder", store)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ConfigurationError, match="no text"):
        load_parameters(path, store)
    path.write_bytes(b"#" * (1 << 20) + b"#")
    with pytest.raises(ConfigurationError, match="longer"):
        load_parameters(path, store)


def options_of(*arguments: str) -> ParameterStore:
    return cli._parameters(build_parser().parse_args(arguments))


def test_options_come_after_the_file(tmp_path: Path) -> None:
    path = tmp_path / "quad.parm"
    path.write_text("WPNAV_SPEED 500\nRTL_ALT 2000\n", encoding="utf-8")
    store = options_of("--parameters", str(path), "--set", "WPNAV_SPEED=700", "--set", "MAV_SYSID = 7")
    assert (store["WPNAV_SPEED"], store["RTL_ALT"], store["MAV_SYSID"]) == (700.0, 2000.0, 7.0)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--set", "WPNAV_SPED=5"], "is WPNAV_SPEED meant"),
        (["--set", "WPNAV_SPEED"], "NAME=VALUE"),
        (["--set", "=5"], "NAME=VALUE"),
        (["--set", "WPNAV_SPEED=5"], "takes 10 to 2000"),
        (["--parameters", "{folder}"], "irectory"),
        (["--parameters", "{folder}/bad.parm"], "bad.parm, line 2: "),
        (["--parameters", "{folder}/none/quad.parm"], "quad.parm: No such file"),
    ],
)
def test_faults_are_one_line_and_exit_code_2(
    options: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bad.parm").write_text("# mine\nRTL_ALT high\n", encoding="utf-8")
    try:
        code = cli.main(["--no-ground-station", *(option.format(folder=tmp_path) for option in options)])
    except SystemExit as stop:
        code = int(stop.code or 0)
    heard = capsys.readouterr().err
    assert code == 2
    assert said in heard
    assert heard.count("\n") == 1
