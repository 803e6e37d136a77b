"""Whatever bytes a file has: it is a mission, or it has faults. Nothing else may happen."""

from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from mission.errors import Fault, SpecError
from mission.geometry import refinement
from mission.spec.loader import parse_mission
from mission.spec.yaml_errors import LINE_BREAK
from tests.support.drawn_cases import tried

MISSIONS = Path(__file__).parents[3] / "missions"
SEEDS = [path.read_bytes() for path in (MISSIONS / "paper.yaml", *sorted((MISSIONS / "broken").glob("*.yaml")))]
TOKENS = (
    *("domain", "regions", "mission", "start", "nodes", "boundary", "kind", "at", "polygon", "triangle", "formula"),
    *("position_m", "flight", "speed_m_s", "survey", "1", "-1", "0.5", ".nan", "1e3", "yes", "~", "[", "]", "{", "}"),
    *(":", ",", "-", "|", ">", "&", "*", "!", "%", "@", "`", "'", '"', "?", "#", "\\", "<<", "&&", "a", "&a", "*a"),
    *("!!set", "---", "...", "\t", "\x85", "\u2028"),
)


def judge(content: bytes) -> None:
    faults: tuple[Fault, ...] = ()
    with pytest.MonkeyPatch.context() as patched:
        # Needles of a thousand kilometres would take as many triangles as are allowed.
        patched.setattr(refinement, "MOST_VERTICES", 300)
        try:
            parse_mission(content, "fuzz.yaml")
        except SpecError as error:
            faults = error.faults or (Fault(0, 0, "", ""),)
    lines = len(LINE_BREAK.findall(content.decode(errors="replace"))) + 2
    for fault in faults:
        str(fault).encode()
        assert fault.message
        assert 0 <= fault.line <= lines


@given(st.binary(max_size=200))
@tried(200)
@example(b"\xff\xfe")
@example(b"? ? ? a")
@example(b"&a [*a]")
@example(b"a: &a {b: *a}")
@example(b"[" * 5000)
@example(b"{a: " * 5000)
@example(b"- " * 5000)
@example(b"domain:\nregions: {A: 1}\n")
@example(b'"\\uD800"')
def test_random_bytes(content: bytes) -> None:
    judge(content)


@given(st.lists(st.sampled_from([*TOKENS, " ", "\n", "\n  "]), max_size=60).map("".join))
@tried(200)
def test_random_words_of_yaml(text: str) -> None:
    judge(text.encode())


@given(
    st.sampled_from(SEEDS), st.lists(st.tuples(st.floats(0, 1), st.sampled_from(TOKENS), st.integers(0, 4)), max_size=4)
)
@tried(300)
def test_mutated_missions(seed: bytes, edits: list[tuple[float, str, int]]) -> None:
    content = seed
    for place, token, cut in edits:
        at = int(place * len(content))
        content = content[:at] + token.encode() + content[at + cut :]
    judge(content)


coordinates = st.one_of(st.integers(-3, 3), st.floats(-1e6, 1e6), st.sampled_from([0.0, 1e-12, 1.0, 1e6, -1e6]))
points = st.lists(st.tuples(coordinates, coordinates), min_size=3, max_size=12)


def ring(corners: list[tuple[float, float]]) -> str:
    return "[" + ", ".join(f"[{x:.17f}, {y:.17f}]" for x, y in corners) + "]"


@given(st.sampled_from(["nodes", "boundary"]), points, points, points, st.tuples(coordinates, coordinates))
@tried(120)
def test_random_geometry(
    kind: str,
    domain: list[tuple[float, float]],
    first: list[tuple[float, float]],
    second: list[tuple[float, float]],
    start: tuple[float, float],
) -> None:
    text = (
        f"domain: {{{kind}: {ring(domain)}}}\n"
        f"regions:\n  A: {{kind: survey, polygon: {ring(first)}}}\n  B: {{kind: restricted, polygon: {ring(second)}}}\n"
        f"  C: {{kind: home, at: {ring([start])[1:-1]}}}\n  D: {{kind: home, triangle: [0, 1, 2]}}\n"
        f"mission: {{formula: F A}}\nstart: {{position_m: {ring([start])[1:-1]}}}\n"
    )
    judge(text.encode())
