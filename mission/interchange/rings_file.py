"""Plain outlines in metres: YAML with ``outer_m``, the outline of an area, and ``holes_m``, a list of its holes."""

import re
from typing import Any, Final

import yaml

from mission.interchange.features import Drawing, Feature, broken
from mission.interchange.json_text import member, points
from mission.interchange.rings import polygon

RINGS: Final = re.compile(r"^outer_m\s*:", re.MULTILINE)
_MOST_CHARACTERS: Final = 1 << 20


class _WithoutAliases(yaml.SafeLoader):
    """So that a short text cannot stand for a large value."""

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError("aliases are not read")
        return super().compose_node(parent, index)


def drawing_of_rings(text: str) -> Drawing:
    """The area of such a text.

    Raises:
        SpecError: It is none.
    """
    if len(text) > _MOST_CHARACTERS:
        raise broken(f"the file is longer than {_MOST_CHARACTERS} characters")
    try:
        data: Any = yaml.load(text, Loader=_WithoutAliases)  # noqa: S506 - a safe loader, and safer
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 0
        raise broken(f"this is not YAML: {error.problem}", line=line) from None
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise broken(f"this is not YAML: {error}") from None
    outline = points(member(data, "outer_m", list, ""), "outer_m")
    rings = [] if data.get("holes_m") is None else member(data, "holes_m", list, "")
    holes = [points(ring, f"holes_m[{i}]") for i, ring in enumerate(rings)]
    area = polygon(outline, holes, broken)
    return Drawing("YAML outline", (Feature("", (area,)),), in_degrees=False)
