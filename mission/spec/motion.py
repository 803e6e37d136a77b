"""How regions and nodes move: the keys, and the value."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Final

from mission.decimals import count, decimal
from mission.spec.shape_schema import Schema, mapping, number, one_of

_LATEST_S: Final = 86_400.0
_FARTHEST_M: Final = 100_000.0
_MOST_WAYPOINTS: Final = 1_000
Waypoint = tuple[float, float, float]


@dataclass(frozen=True)
class Motion:
    """How something moves, by the clock of the trajectory: from where it is drawn, to where it stays in the end.

    Attributes:
        waypoints: Rows of a time, s, and by how much it is displaced then, east and north, m; times ascend from 0,
            where it is not displaced.
        smooth: Whether it goes through the way-points without kinks, by the monotone cubic of Fritsch and Carlson;
            otherwise straight from one to the next.
    """

    waypoints: tuple[Waypoint, ...]
    smooth: bool = False

    @property
    def spans_s(self) -> tuple[float, float]:
        """From when to when it moves; twice the same where it never does."""
        stands = next((k for k, row in enumerate(self.waypoints) if any(row[1:])), len(self.waypoints)) - 1
        return self.waypoints[stands][0], self.waypoints[-1][0]

    @property
    def moves(self) -> bool:
        """Whether it is ever displaced."""
        return any(east or north for _, east, north in self.waypoints)

    @property
    def text(self) -> str:
        """In words, after what moves: ``by [20, 0] m from 10 to 40 s``."""
        (begin_s, end_s), (_, east, north) = self.spans_s, self.waypoints[-1]
        if begin_s == end_s:
            return "by nothing"
        where = f"by [{decimal(east)}, {decimal(north)}] m" if east or north else "out and back"
        inner = sum(begin_s < time_s < end_s for time_s, *_ in self.waypoints)
        through = f" through {count(inner, 'way-point')}" if inner else ""
        when = f"from {decimal(begin_s)} to {decimal(end_s)} s" if begin_s else f"until {decimal(end_s)} s"
        return f"{where}{through} {when}{', smoothly' if self.smooth and inner else ''}"


_MOTION_KEYS: Final[Schema] = {
    "velocity_m_s": {
        "description": "A constant velocity, [east, north], m/s.",
        "type": "array",
        "items": {"type": "number", "minimum": -100.0, "maximum": 100.0},
        "minItems": 2,
        "maxItems": 2,
        "examples": [[0.5, 0.0]],
    },
    "from_s": number(
        "When it begins to move with that velocity, s after the trajectory begins.", 0.0, _LATEST_S, default=0.0
    ),
    "until_s": number("When it stops, s after the trajectory begins.", 0.001, _LATEST_S, examples=[60.0]),
    "waypoints": {
        "description": "Rows of [time in s after the trajectory begins, metres east, metres north from where it is "
        "drawn]: straight from one to the next; it stays at the last one.",
        "type": "array",
        "items": {
            "type": "array",
            "items": {"type": "number", "minimum": -_FARTHEST_M, "maximum": _FARTHEST_M},
            "minItems": 3,
            "maxItems": 3,
        },
        "minItems": 1,
        "maxItems": _MOST_WAYPOINTS,
        "examples": [[[20, 0, 0], [60, 30, 0]]],
    },
    "smooth": {
        "description": "Whether it goes through its way-points without kinks.",
        "type": "boolean",
        "default": False,
    },
}
_TOGETHER: Final[Schema] = {
    "oneOf": one_of("velocity_m_s", "waypoints"),
    "dependentRequired": {
        "velocity_m_s": ["until_s"],
        "from_s": ["velocity_m_s"],
        "until_s": ["velocity_m_s"],
        "smooth": ["waypoints"],
    },
}
_EXAMPLES: Final = [{"velocity_m_s": [0.5, 0.0], "until_s": 60}, {"waypoints": [[20, 0, 0], [60, 30, 0]]}]

MOTION: Final = mapping(
    "How it moves, by the clock of the trajectory: with a velocity up to some time, or through way-points.",
    (),
    _MOTION_KEYS,
    examples=_EXAMPLES,
    **_TOGETHER,
)
NODE_MOTIONS: Final[Schema] = {
    "description": "How some of the nodes move; their triangles go with them. Those of the hull stay.",
    "type": "array",
    "items": mapping(
        "Nodes that move alike.",
        ("nodes",),
        {
            "nodes": {
                "description": "Their numbers, from 0.",
                "type": "array",
                "items": {"type": "integer", "minimum": 0, "maximum": 1_000_000},
                "minItems": 1,
                "maxItems": 10_000,
                "uniqueItems": True,
                "examples": [[4, 10]],
            },
            **_MOTION_KEYS,
        },
        **_TOGETHER,
    ),
    "minItems": 1,
    "maxItems": 1_000,
    "examples": [[{"nodes": [4, 10], "velocity_m_s": [0.02, 0.0], "until_s": 60}]],
}


def motion_of(data: dict[str, Any]) -> Motion:
    """The motion that its keys give, whose times ascend."""
    if "velocity_m_s" in data:
        east, north = (float(x) for x in data["velocity_m_s"])
        begin_s, end_s = float(data.get("from_s", 0.0)), float(data["until_s"])
        rows = [(begin_s, 0.0, 0.0), (end_s, east * (end_s - begin_s), north * (end_s - begin_s))]
    else:
        rows = [(float(t), float(x), float(y)) for t, x, y in data["waypoints"]]
    still = [(0.0, 0.0, 0.0)] if rows[0][0] > 0.0 else []
    return Motion((*still, *rows), bool(data.get("smooth", False)))


def motion_data(motion: Motion) -> dict[str, Any]:
    """The keys of a motion; the opposite of ``motion_of``."""
    return {"waypoints": [list(row) for row in motion.waypoints], **({"smooth": True} if motion.smooth else {})}


def motion_fault(data: dict[str, Any]) -> tuple[str, str] | None:
    """What is wrong with the times of a motion whose keys fit the schema, and what to write; None where nothing is."""
    rows = data.get("waypoints")
    if rows is None:
        begin_s, end_s = data.get("from_s", 0.0), data["until_s"]
        if begin_s >= end_s:
            return f"it would move from {begin_s:g} s until {end_s:g} s", "write an `until_s` after `from_s`"
        return None
    times = [row[0] for row in rows]
    if times[0] < 0.0 or any(a >= b for a, b in pairwise(times)):
        return "the times of its way-points do not ascend from 0", "write each later than the one before"
    if times[-1] > _LATEST_S:
        return f"its last way-point is at {times[-1]:g} s", f"write times up to {_LATEST_S:g} s"
    if times[0] == 0.0 and any(rows[0][1:]):
        hint = "begin with [0, 0, 0], or with a row of a later time without displacement"
        return "at its first way-point it is displaced: it would have to jump there", hint
    return None
