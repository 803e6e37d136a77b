"""Changes of a mission in words: whatever is written is a mission, or is refused in words."""

import pytest

from mission.errors import SpecError
from mission.spec.amendment import amended
from mission.spec.loader import parse_mission
from tests.support.small_missions import SMALL

REFUSED = (
    ("laps " + "9" * 5_000, "no number of laps"),
    ("restrict K " + "[" * 3_000 + "]" * 3_000, "nested deeper"),
    ("restrict K " + "{a: " * 2_000 + "1" + "}" * 2_000, "nested deeper"),
    ("restrict K {centre: 2001-01-01, radius_m: 3}", "reads as a date"),
    ("restrict K {centre: 2001-99-99, radius_m: 3}", "reads as a date"),
    ("restrict K {centre: [3, 3], radius_m: !!binary aGVs}", "the tag `!!binary`"),
    ("restrict K &a [*a]", "alias"),
    ("restrict K [[0x" + "f" * 5_000 + ", 1], [2, 1], [2, 2]]", "decimal"),
    ("restrict K [[" + "9" * 5_000 + ", 1], [2, 1], [2, 2]]", "decimal"),
    ("restrict K [[1:2:3, 1], [2, 1], [2, 2]]", "sexagesimal"),
    ("restrict K", "a name and a shape"),
)


@pytest.mark.parametrize(("line", "words"), REFUSED, ids=[line[:24] for line, _ in REFUSED])
def test_a_line_that_is_no_change_is_refused_in_words(line: str, words: str) -> None:
    """The flight that it is for goes on: nothing but a refusal may come of it."""
    with pytest.raises(SpecError, match=words):
        amended(parse_mission(SMALL.encode()), (line,), (9.0, 8.0))


def test_a_shape_is_read_as_in_a_mission_file() -> None:
    mission = amended(
        parse_mission(SMALL.encode()), ("restrict K {centre: [2e1, 18], radius_m: 1.5, clearance_m: 1}",), (9.0, 8.0)
    )
    [region] = [region for region in mission.regions if region.name == "K"]
    assert region.clearance_m == 1.0
