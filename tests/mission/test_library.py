"""The library's face: its names, its examples, and that it loads nothing before it is used."""

import doctest
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import mission
from mission import library
from mission.report.reading import read_record
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import SMALL, plan_of

README = Path(mission.__file__).with_name("README.md")


def test_every_name_is_there_and_documented() -> None:
    for name in mission.__all__:
        assert getattr(mission, name).__doc__, name
    assert set(mission.__all__) <= set(dir(mission))
    assert re.fullmatch(r"\d+\.\d+\.\d+", mission.__version__)
    with pytest.raises(AttributeError, match="no attribute 'plan_misson'"):
        _ = mission.plan_misson


def test_no_name_hides_a_room() -> None:
    rooms = {path.name for path in README.parent.iterdir() if (path / "__init__.py").is_file()}
    assert not rooms & set(mission.__all__)


def test_the_example_of_the_documentation_is_true() -> None:
    assert isinstance(mission, ModuleType)
    assert doctest.testmod(mission) == (0, 6)


def test_the_paper_in_thirty_lines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (example,) = re.findall("```python\n(.*?)```", README.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert sum(bool(line) for line in example.splitlines()) <= 30
    (tmp_path / "missions").symlink_to(README.parents[1] / "missions")
    monkeypatch.chdir(tmp_path)
    exec(compile(example, "README.md", "exec"), {})  # noqa: S102 - the example of this project's own page
    assert mission.plan_from_json(Path("paper.plan.json").read_text(encoding="utf-8")).run.states[-1] == 10


def test_importing_it_loads_nothing_heavy() -> None:
    loaded = "import sys, mission; print(*sorted(n for n in ('numpy', 'scipy', 'pymavlink') if n in sys.modules))"
    told = subprocess.run([sys.executable, "-c", loaded], check=True, capture_output=True)  # noqa: S603 - this program
    assert told.stdout.strip() == b""


def judged_alike(folder: Path) -> None:
    (flown,) = folder.iterdir()
    plan = plan_of(SMALL)
    assert read_record(flown).track.t_s[-1] > 10.0
    assert mission.judge_flight(flown, plan.spec, plan=plan).achieved
    assert mission.load_mission(flown / "mission.yaml").regions == plan.spec.regions


def test_a_flight_leaves_a_folder_that_is_judged_alike(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def in_lockstep(*_: object) -> tuple[None, LockstepVehicle, LockstepVehicle]:
        vehicle = LockstepVehicle(vehicle_of("ardupilot"))
        return None, vehicle, vehicle

    monkeypatch.setattr(library, "linked", in_lockstep)
    result = library.fly_plan(plan_of(SMALL), "udpin:127.0.0.1:14550", folder=tmp_path)
    assert result.achieved, result.reason
    judged_alike(tmp_path)


@pytest.mark.long
def test_the_bundled_vehicle_is_started_for_it(tmp_path: Path) -> None:
    vehicle = mission.VehicleOptions(speed=100.0, ground_station=False)
    assert mission.fly_plan(plan_of(SMALL), folder=tmp_path, vehicle=vehicle).achieved
    judged_alike(tmp_path)
