"""How many passages are planned and proved in meshes as coarse as the outlines allow, and in finer ones.

python -m pytest -m bench -n 0 -s tests/bench/test_bench_passages.py
"""

import numpy as np
import pytest

from mission.errors import NoPlanError
from mission.plan import plan_mission
from mission.spec.loader import parse_mission
from tests.support.passages import TUBE_M, passage

WIDTHS_M = (1.6, 1.05)  # the tube takes 1 m
SEEDS = 4
FINER = ("", "largest_m: 4")


def tried(width_m: float, mesh: str) -> list[float]:
    """How long the flights last that are proved, of all seeds."""
    found = []
    for seed in range(SEEDS):
        try:
            found.append(plan_mission(parse_mission(passage(seed, width_m, mesh))).trajectory.duration_s)
        except NoPlanError:
            continue
    return found


@pytest.mark.bench
@pytest.mark.timeout(3000)
def test_passages_are_proved_as_often_in_coarse_meshes_as_in_finer_ones() -> None:
    print(f"\nproved of {SEEDS}, and the mean duration, with a tube of {2.0 * TUBE_M:g} m")
    for width_m in WIDTHS_M:
        coarse, finer = (tried(width_m, mesh) for mesh in FINER)
        rates = ", ".join(f"{len(of)} ({np.mean(of):.1f} s)" for of in (coarse, finer))
        print(f"{width_m:g} m wide: as coarse as can be and no edge above 4 m: {rates}")
        assert len(coarse) >= len(finer)
