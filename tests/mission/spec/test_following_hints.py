"""Whoever does what the messages say, one fault after the other, ends with a sound file."""

import json
import re
from copy import deepcopy
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.errors import SpecError
from mission.spec.domain import build_domain
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec

Data = dict[str, Any]

PAIR = r"\[-?[0-9.]+, -?[0-9.]+\]"
MOVE = re.compile(rf"move corner (\d+) of (\w+) to ({PAIR})")
PUT = re.compile(rf"put ((?:{PAIR}(?:, )?)+) between corners (\d+) and \d+ of (the boundary|\w+)")
ADD = re.compile(rf"add to domain.points a point on each gap in the edge, such as ((?:{PAIR}(?:, )?)+)")


def ring_of(data: Data, name: str) -> list[list[float]]:
    ring: list[list[float]] = data["domain"]["boundary"] if name == "the boundary" else data["regions"][name]["polygon"]
    return ring


def pairs(text: str) -> list[list[float]]:
    return [json.loads(found) for found in re.findall(PAIR, text)]


def done(data: Data, hint: str) -> Data:
    """The file after one hint was followed."""
    data = deepcopy(data)
    for corner, name, place in MOVE.findall(hint):
        ring_of(data, name)[int(corner)] = json.loads(place)
    for places, edge, name in sorted(PUT.findall(hint), key=lambda found: -int(found[1])):
        ring_of(data, name)[int(edge) + 1 : int(edge) + 1] = pairs(places)
    for places in ADD.findall(hint):
        data["domain"].setdefault("points", []).extend(pairs(places))
    return data


def followed(data: Data, most: int = 60) -> tuple[MissionSpec, list[str]]:
    """The mission that comes out at the end, and the messages on the way."""
    said: list[str] = []
    for _ in range(most):
        try:
            return parse_mission(json.dumps(data).encode()), said
        except SpecError as error:
            said.append(f"{error.faults[0].path}: {error.faults[0].message}; {error.faults[0].hint}")
            after = done(data, error.faults[0].hint)
            assert after != data, said
            data = after
    raise AssertionError(said)


def rounded(points: Any, digits: int) -> list[list[float]]:  # noqa: ANN401 - whatever numpy can read
    return [[round(float(x), digits), round(float(y), digits)] for x, y in np.asarray(points)]


def along(a: Any, b: Any, *shares: float) -> list[Any]:  # noqa: ANN401 - points
    return [np.asarray(a) + share * (np.asarray(b) - np.asarray(a)) for share in shares]


def mission(boundary: Any, regions: dict[str, Any]) -> Data:  # noqa: ANN401 - a ring
    shapes = {
        name: {"kind": "restricted" if name.startswith("k") else "survey", "polygon": ring}
        for name, ring in regions.items()
    }
    home = {"home": {"kind": "home", "polygon": [[10, 10], [20, 10], [20, 20], [10, 20]]}}
    return {
        "domain": {"boundary": boundary},
        "regions": home | shapes,
        "mission": {"formula": "F home"},
        "start": {"position_m": [15, 15]},
    }


@pytest.mark.parametrize("offset_m", [1e-3, -1e-3, 1e-6, -1e-6, 0.01, -0.01])
def test_neighbours_that_nearly_share_an_edge_are_one_fault(offset_m: float) -> None:
    top = 35 - offset_m
    a, b = [[55, 35], [70, 35], [70, 50], [55, 50]], [[55, 20], [70, 20], [70, top], [55, top]]
    data = mission([[0, 0], [80, 0], [80, 60], [0, 60]], {"a": a, "b": b})
    spec, said = followed(data)
    assert len(said) <= 1
    assert not said or "b and a nearly touch" in said[0]
    partition, labelling = build_domain(spec)
    assert partition.areas_m2[labelling.triangles_of("b")].sum() == pytest.approx(225.0, abs=0.2)


@pytest.mark.parametrize("offset_m", [0.01, 0.0, -0.01, 1e-6, -1e-6])
def test_a_restricted_region_beside_a_slanted_border_is_one_fault(offset_m: float) -> None:
    boundary = [[0, 0], [81.37, 11.93], [70.11, 72.4], [3.3, 60.2]]
    polygon = [[27.12, 3.98 + offset_m], [54.25, 7.95 + offset_m], [52, 20], [26, 18]]
    spec, said = followed(mission(boundary, {"k2": polygon}))
    assert len(said) == 1
    assert "k2 and the boundary nearly touch" in said[0]
    assert len(spec.domain.boundary_m) == 6  # type: ignore[union-attr]


def test_the_points_that_a_hint_names_lie_on_the_edge() -> None:
    for east, north in ((0.0, 0.0), (500123.41, 412345.67)):
        shift = np.array([east, north])
        road = np.array([[40, 0], [44, 0], [144.3, 100], [140.3, 100]])
        data = mission(rounded(np.array([[0, 0], [200, 0], [200, 100], [0, 100]]) + shift, 2), {})
        data["regions"] = {"road": {"kind": "restricted", "polygon": rounded(road + shift, 2)}}
        data["start"]["position_m"] = rounded([shift + 12], 2)[0]
        data["mission"]["formula"] = "G !road"
        _, said = followed(data)
        assert 0 < len(said) < 12


@given(st.integers(0, 10**6), st.integers(1, 3))
@settings(max_examples=25, deadline=None)
def test_any_slanted_rounded_map_ends_sound(seed: int, digits: int) -> None:
    rng = np.random.default_rng(seed)
    extent = float(rng.choice([100.0, 400.0]))
    boundary = np.array([[0, 0], [1, 0.1], [0.9, 1], [0.05, 0.85]]) * extent + rng.uniform(0, 0.05, (4, 2)) * extent
    boundary[0] = (0.0, 0.0)
    boundary = np.array(rounded(boundary, digits))
    # One region beside the border, one beside that one, one in between, each drawn on slanting edges and rounded.
    p, q = along(boundary[1], boundary[2], rng.uniform(0.3, 0.45), rng.uniform(0.55, 0.75))
    inward = np.array([-0.15, rng.uniform(-0.02, 0.02)]) * extent
    k = [p, q, q + inward, p + inward]
    s, t = along(k[3], k[2], rng.uniform(-0.2, 0.4), rng.uniform(0.6, 1.2))
    further = np.array([-0.12, rng.uniform(-0.02, 0.02)]) * extent
    a = [s, t, t + further, s + further]
    regions = {"k": rounded(k, digits), "a": rounded(a, digits)}
    if rng.random() < 0.5:
        u, v = along(a[2], a[3], 0.0, 1.0)
        deeper = np.array([-0.1 * extent, 0.0])
        regions["b"] = rounded([v, u, u + deeper, v + deeper], digits)
    data = mission(boundary.tolist(), regions)
    spec, _ = followed(data)
    partition, _ = build_domain(spec)
    assert partition.areas_m2.sum() > 0.5 * extent**2
