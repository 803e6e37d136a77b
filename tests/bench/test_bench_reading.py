"""What reading a map of 100,000 triangles takes, against parsing its text and against planning it."""

import json
from functools import partial

import numpy as np
import pytest
import yaml

from mission.plan import plan_mission
from mission.spec import yaml_tree
from mission.spec.loader import parse_mission
from mission.spec.structure import plain_data, structure_findings
from tests.support.measuring import Bar, at_most, seconds, table, timed

pytestmark = [pytest.mark.bench, pytest.mark.timeout(600)]

SIDE, ROUNDS = 225, 3
OF_PLANNING, OF_PARSING = 20, 50  # per cent


def jittered_map() -> list[list[float]]:
    rng = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(np.arange(SIDE), np.arange(SIDE)), axis=-1).reshape(-1, 2).astype(float)
    inner = ((grid > 0) & (grid < SIDE - 1)).all(axis=1)
    grid[inner] += rng.uniform(-0.3, 0.3, (inner.sum(), 2))
    nodes: list[list[float]] = (4.0 * grid).round(3).tolist()
    return nodes


def texts() -> dict[str, str]:
    """The same mission in brackets and with dashes."""
    nodes, middle = jittered_map(), 2.0 * SIDE + 0.9
    rest = f"""
regions:
  a: {{kind: survey, at: [{middle}, {middle + 0.2}]}}
  b: {{kind: restricted, at: [{middle / 2 + 0.3}, 31.2]}}
mission: {{formula: F a & G !b}}
start: {{position_m: [9.1, 8.7]}}
"""
    lines = "".join(f"\n  - [{x}, {y}]" for x, y in nodes)
    return {"brackets": f"domain:\n  nodes: {json.dumps(nodes)}{rest}", "dashes": f"domain:\n  nodes:{lines}{rest}"}


def read(text: str) -> None:
    """All that comes before geometry: the tree, the data, and their structure."""
    tree, _ = yaml_tree.read_tree(text)
    data, _ = plain_data(tree)
    assert not structure_findings(data, tree)


def parse(text: str) -> None:
    """The events of the C parser, and nothing made of them."""
    for _ in yaml.parse(text, Loader=yaml.CSafeLoader):
        pass


def test_bench_reading(monkeypatch: pytest.MonkeyPatch) -> None:
    bars: list[Bar] = []
    for written, text in texts().items():
        reading = timed(partial(read, text), ROUNDS).processor_s
        parsing = timed(partial(parse, text), ROUNDS).processor_s
        spec = parse_mission(text.encode())
        planning = timed(partial(plan_mission, spec), 1).processor_s
        with monkeypatch.context() as patch:
            patch.setattr(yaml_tree, "without_tables", lambda text: (text, {}))
            value_by_value = timed(partial(read, text), 1).processor_s
        print(
            f"\n{written}: {seconds(reading)} of reading; value by value {value_by_value / reading:.0f} times as long"
        )
        bars.append(at_most(f"reading, % of planning, {written}", round(100 * reading / planning), OF_PLANNING))
        bars.append(at_most(f"reading, % of the C parser alone, {written}", round(100 * reading / parsing), OF_PARSING))
    print(f"\n{table(bars)}")
    assert not [bar.what for bar in bars if not bar.met]
