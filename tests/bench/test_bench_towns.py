"""What planning with proof takes on maps that outlines make: towns of ever more buildings.

    python -m pytest -m bench -n 0 -s tests/bench/test_bench_towns.py

Seconds are of the processor, beyond imports and the reading of the file; the memory is the most that the process had
until then, so that towns come in the order of their size. A loop of a million turns says how fast the machine is.
"""

import resource
from pathlib import Path
from time import process_time

import pytest

from mission.plan import plan_mission
from mission.spec.loader import load_mission, parse_mission
from tests.support.measuring import loop, timed
from tests.support.towns import town

SURVEY = Path(__file__).parents[2] / "missions" / "survey.yaml"
SIDES = (0, 10, 26, 45, 82)  # rows of buildings; none for the survey; 26 make 10,056 triangles, 82 make 97,629


@pytest.mark.bench
@pytest.mark.timeout(1200)
def test_bench_towns() -> None:
    print(f"\n{'mission':<28}{'triangles':>10}{'path m':>9}{'s':>8}{'MB':>7}{'loops':>8}")
    for side in SIDES:
        spec = parse_mission(town(side)) if side else load_mission(SURVEY)
        begun_s = process_time()
        plan = plan_mission(spec)
        took_s = process_time() - begun_s
        peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        loops = took_s / timed(loop, 3).processor_s
        row = f"{plan.partition.size:10,}{plan.curve.length_m:9.1f}{took_s:8.2f}{peak_mb:7.0f}{loops:8.0f}"
        print(f"{spec.name:<28}{row}", flush=True)
        assert plan.certificate.holds
        assert not plan.instead
