"""Small missions on maps of chance: two places to be in, restricted regions that overlap them or not, one formula."""

import math
import random
from typing import Any

import yaml

from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec

_FORMULAS = (
    "F (a & F b)",
    "F a & F b",
    "G F a & G F b",
    "!b U a & F b",
    "F (a & F (b & F a))",
    "F G a & F b",
    "G (a -> F b) & F a",
    "F a & G (a -> X F b)",
)


def random_mission(seed: int) -> MissionSpec:
    """The mission of a seed.

    Raises:
        SpecError: It begins in what is restricted, or the like.
    """
    return parse_mission(yaml.safe_dump(random_document(seed)).encode(), f"map {seed}")


def random_document(seed: int) -> dict[str, Any]:
    """The same as plain data."""
    r = random.Random(seed)  # noqa: S311 - maps, no secrets
    width, height = round(r.uniform(30, 150), 1), round(r.uniform(30, 120), 1)
    size = min(width, height)
    regions: dict[str, dict[str, Any]] = {
        name: {"kind": r.choice(kinds), "polygon": _polygon(r, width, height, r.uniform(0.08, 0.2) * size)}
        for name, kinds in (("a", ("survey", "area")), ("b", ("survey", "area", "home")))
    }
    restricted = [f"K{number}" for number in range(r.randint(0, 2))]
    for name in restricted:
        polygon = _polygon(r, width, height, r.uniform(0.05, 0.2) * size)
        regions[name] = {"kind": "restricted", "polygon": polygon}
    if r.random() < 0.3:
        regions["a"]["loiter_s"] = r.choice([0.5, 3, 5])
    if r.random() < 0.2:
        regions["b"]["speed_m_s"] = r.choice([0.5, 1, 2])
    if r.random() < 0.25:
        regions["a"] |= {"kind": "survey", "cover": {"spacing_m": round(r.uniform(2, 6), 1)}}
    document: dict[str, Any] = {
        "domain": {"boundary": [[0, 0], [width, 0], [width, height], [0, height]]},
        "regions": regions,
        "mission": {"formula": r.choice(_FORMULAS) + "".join(f" & G !{name}" for name in restricted)},
        "start": {"position_m": [round(r.uniform(3, width - 3), 1), round(r.uniform(3, height - 3), 1)]},
    }
    if r.random() < 0.3:
        document["domain"]["restricted_clearance_m"] = r.choice([0.5, 1, 2])
    flight: dict[str, Any] = {}
    if r.random() < 0.3:
        flight["speed_m_s"] = r.choice([1, 3, 5])
    if r.random() < 0.25:
        flight["heading"] = r.choice(["ahead", "lanes", {"fixed": 90}, {"toward": "b"}])
    if r.random() < 0.2:
        document["search"] = {"cost": r.choice(["transitions", "time", "distance"])}
    if r.random() < 0.1:
        document["smoothing"] = {"extension": "odd", "frequencies": "auto"}
    return document | ({"flight": flight} if flight else {})


def _polygon(r: random.Random, width: float, height: float, size: float) -> list[list[float]]:
    """A rectangle, or some corners on rays around a place."""
    x, y = r.uniform(0.15, 0.85) * width, r.uniform(0.15, 0.85) * height
    if r.random() < 0.5:
        a, b = r.uniform(0.4, 1) * size, r.uniform(0.4, 1) * size
        corners = [(x - a, y - b), (x + a, y - b), (x + a, y + b), (x - a, y + b)]
    else:
        first, count = r.uniform(0, 6.28), r.choice([3, 4, 5, 6])
        rays = [(first + math.tau * k / count, size * r.uniform(0.6, 1)) for k in range(count)]
        corners = [(x + away * math.cos(ray), y + away * math.sin(ray)) for ray, away in rays]
    return [[round(east, 1), round(north, 1)] for east, north in corners]
