"""What somebody wants of a drawing, beside what the drawing tells: which regions are for what, how high, how fast."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from mission.errors import Fault, SpecError
from mission.interchange.features import Drawing, Feature, Polygon, Role, points_of
from mission.spec.finding import rather

VISIT: Final = "visit"
ALL: Final = "all"
ROLES: Final = {VISIT: Role.SURVEY, "avoid": Role.RESTRICTED, "home": Role.HOME, "boundary": Role.BOUNDARY}
"""What something drawn can be wanted for, and its role then."""

_INSET: Final = 0.25

Drawings = Sequence[tuple[str, Drawing]]
"""Each with the name of its file without its ending."""


@dataclass(frozen=True)
class Wishes:
    """What is wanted. Capital letters of names do not matter.

    Attributes:
        names: Of what is drawn, by what it is wanted for, a key of ``ROLES``. To be visited, ``all`` is whatever is for
            nothing else.
        altitude_m: How high; None as the drawing tells.
        speed_m_s: How fast, likewise.
    """

    names: Mapping[str, tuple[str, ...]]
    altitude_m: float | None = None
    speed_m_s: float | None = None

    @property
    def visits_all(self) -> bool:
        """Whether whatever is for nothing else is to be visited."""
        return ALL in self.names.get(VISIT, ())

    def named(self) -> Iterator[tuple[str, str]]:
        """What each name is wanted for, and the name."""
        for wish, names in self.names.items():
            yield from ((wish, name) for name in names if (wish, name) != (VISIT, ALL))


def plain_field(east_m: float, north_m: float) -> Drawing:
    """A rectangle of this size to fly in, with a field in its middle: what a mission can begin with."""

    def rectangle(inset: float) -> Polygon:
        west, east, south, north = (
            round(length_m * share, 2) for length_m in (east_m, north_m) for share in (inset, 1.0 - inset)
        )
        return Polygon(((west, south), (east, south), (east, north), (west, north)))

    ground = Feature("boundary", (rectangle(0.0),), Role.BOUNDARY)
    field = Feature("field", (rectangle(_INSET),), Role.SURVEY)
    return Drawing("a plain field", (ground, field), in_degrees=False)


def names_in(drawings: Drawings) -> dict[str, Role | None]:
    """What is drawn, by its names, and what the drawings tell of its role."""
    return {_name(each, file): each.role for file, drawing in drawings for each in drawing.features}


def wished(drawings: Drawings, wishes: Wishes) -> list[tuple[str, Drawing]]:
    """The drawings as they are wanted.

    Raises:
        SpecError: Nothing of a name is drawn, or a name stands in two wishes.
    """
    roles = _roles(tuple(names_in(drawings)), wishes)
    left = [
        feature
        for file, drawing in drawings
        for feature in drawing.features
        if feature.role in (None, Role.AREA) and _name(feature, file) not in roles
    ]
    bounded = Role.BOUNDARY in {*roles.values(), *names_in(drawings).values()}
    around = None if bounded else _around(drawings, left)
    visited = [each for each in left if each is not around] if wishes.visits_all else []
    return [
        (
            file,
            replace(
                drawing,
                features=tuple(
                    _given(each, Role.SURVEY if each in visited else roles.get(_name(each, file)))
                    for each in drawing.features
                ),
                altitude_m=wishes.altitude_m or drawing.altitude_m,
                speed_m_s=wishes.speed_m_s or drawing.speed_m_s,
            ),
        )
        for file, drawing in drawings
    ]


def _roles(drawn: Sequence[str], wishes: Wishes) -> Mapping[str, Role]:
    roles: dict[str, Role] = {}
    faults = []
    for wish, name in wishes.named():
        found = next((each for each in drawn if each.casefold() == name.casefold()), None)
        if found is None:
            hint = rather(name, drawn, "names")
            faults.append(Fault(0, 0, f"--{wish}", f"nothing is drawn by the name of {name}", hint))
        elif roles.setdefault(found, ROLES[wish]) is not ROLES[wish]:
            faults.append(Fault(0, 0, f"--{wish}", f"{found} is to be something else, too", "name it once"))
    if faults:
        raise SpecError(tuple(faults))
    return roles


def _given(feature: Feature, role: Role | None) -> Feature:
    return feature if role is None else replace(feature, role=role, reason="as it was wanted")


def _around(drawings: Drawings, left: Sequence[Feature]) -> Feature | None:
    """What may be the boundary: the polygon whose bounds hold those of all else, where there is something else."""
    boxes = {
        id(each): np.array([np.min(points, axis=0), -np.max(points, axis=0)])
        for _, drawing in drawings
        for each in drawing.features
        for points in [np.array([point for shape in each.shapes for point in points_of(shape)])]
    }
    least = np.min([*boxes.values()], axis=0) if boxes else None
    drawn = [each for each in left if isinstance(each.shapes[0], Polygon)] if len(boxes) > 1 else []
    return next((each for each in drawn if (boxes[id(each)] <= least).all()), None)


def _name(feature: Feature, file: str) -> str:
    return feature.name or file
