"""What names and properties say that a feature is for."""

import pytest

from mission.interchange.features import Role
from mission.interchange.roles import role_of


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("road", Role.RESTRICTED),
        ("Road to inspect", Role.SURVEY),  # what is to be done comes before what it is
        ("no-fly field", Role.RESTRICTED),
        ("survey boundary", Role.BOUNDARY),
        ("powerLine", Role.RESTRICTED),
        ("North Field", Role.SURVEY),
        ("launch_pad", Role.HOME),
        ("lawn", Role.AREA),
        ("homestead", None),
        ("", None),
    ],
)
def test_names(name: str, role: Role | None) -> None:
    assert role_of({}, name, ()) == (role, "told by its name" if role else "")


def test_properties_come_before_names_and_folders_after() -> None:
    assert role_of({"kind": "area"}, "field", ())[0] is Role.AREA
    assert role_of({"building": "yes"}, "field", ())[0] is Role.RESTRICTED
    assert role_of({"building": "no"}, "field", ())[0] is Role.SURVEY
    assert role_of({}, "A", ["farm", "no fly zones"]) == (Role.RESTRICTED, "told by its folder")
    assert role_of({}, "A", (), fill="e00000") == (Role.RESTRICTED, "told by its red fill")
