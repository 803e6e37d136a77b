"""Mission items for where the nose looks and how fast regions are flown through."""

from itertools import pairwise

import pytest

from mission.export.placed_plan import placed_plan
from mission.export.uploads import autopilot_plan
from mission.geometry.geodesy import LatLon, enu_offset_m
from mission.interchange.autopilot_plan import Command, Item
from tests.support.small_missions import PHOTOGRAPHED, ROUNDS, SMALL, plan_of

PLACE = LatLon(-35.3632, 149.1652)
SLOW = ROUNDS.replace("east: {kind: survey,", "east: {kind: survey, speed_m_s: 1.5,")


def items_of(text: str, firmware: str = "ardupilot", **flight: str) -> tuple[Item, ...]:
    asked = "".join(f"flight:\n  {key}: {value}\n" for key, value in flight.items())
    plan = plan_of(text.replace("flight:\n", asked) if asked else text)
    return autopilot_plan(placed_plan(plan, PLACE, 0.2), firmware).items


def kinds(items: tuple[Item, ...]) -> list[Command]:
    return [item.command for item in items]


def test_a_fixed_heading_is_px4s_own_of_each_waypoint() -> None:
    items = items_of(SMALL, "px4", heading="{fixed: -90}")
    headings = [item.params[3] for item in items if item.command is Command.WAYPOINT]
    assert headings == pytest.approx([270.0] * len(headings))
    assert Command.TURN not in kinds(items)


def test_arducopter_is_turned_to_a_fixed_heading_before_each_waypoint() -> None:
    items = items_of(SMALL, heading="{fixed: -90}")
    for before, item in pairwise(items):
        if item.command is Command.WAYPOINT:
            assert before.command is Command.TURN
            assert before.params == pytest.approx((270.0, 45.0, 0.0, 0.0))
            assert item.params[3] != item.params[3]


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_a_region_is_looked_at_from_the_first_waypoint_on_and_not_while_landing(firmware: str) -> None:
    items = items_of(SMALL, firmware, heading="{toward: pond}")
    (look,) = (item for item in items if item.command is Command.LOOK_AT)
    assert look.place is not None
    assert enu_offset_m(PLACE, look.place) == pytest.approx((9.0, 25.0), abs=0.01)
    assert items[items.index(look) + 1].command is Command.WAYPOINT
    assert kinds(items)[-2:] == [Command.LOOK_AHEAD, Command.LAND]


def test_each_lap_begins_by_looking_where_it_should_and_at_the_usual_speed() -> None:
    items = items_of(SLOW, heading="{toward: pond}")
    (jump,) = (item for item in items if item.command is Command.JUMP)
    begin = int(jump.params[0])
    assert Command.LOOK_AT in kinds(items)[begin : begin + 2]
    assert Command.WAYPOINT not in kinds(items)[begin : begin + 1]
    changes = [item.params[1] for item in items[: items.index(jump)] if item.command is Command.CHANGE_SPEED]
    assert changes[0] == changes[-1] == 5.0
    assert set(changes) == {5.0, 1.5}


def test_the_nose_looks_along_the_lanes_while_images_are_taken() -> None:
    items = items_of(PHOTOGRAPHED, "px4", heading="{fixed: 33}")
    imaging = False
    for item in items:
        if item.command is Command.TRIGGER_CAMERA:
            imaging = item.params[0] > 0.0
        elif item.command is Command.WAYPOINT:
            assert (item.params[3] == pytest.approx(33.0)) is not imaging
    looking = kinds(items_of(PHOTOGRAPHED, heading="{toward: home}"))
    assert looking.count(Command.LOOK_AT) > 1
    assert looking.count(Command.LOOK_AHEAD) > 1


@pytest.mark.parametrize("asked", [{}, {"heading": "ahead"}, {"heading": "lanes"}])
def test_ahead_is_what_autopilots_do_by_themselves(asked: dict[str, str]) -> None:
    items = items_of(SMALL, **asked)
    assert not {Command.TURN, Command.LOOK_AT, Command.LOOK_AHEAD} & set(kinds(items))


def test_a_region_that_is_flown_through_slowly_is_reached_slowly() -> None:
    """The way on which to brake from 5 to 1.5 m/s at 3 m/s² is 3.8 m."""
    items, here = items_of(SLOW), (9.0, 8.0)
    speed_m_s, slow = 0.0, []
    for item in items:
        if item.command is Command.CHANGE_SPEED:
            speed_m_s = item.params[1]
        elif item.command is Command.WAYPOINT and item.place is not None:
            there = enu_offset_m(PLACE, item.place)
            slow += [here, there] if speed_m_s == 1.5 else []
            here = there
    assert 26.0 - 3.8 - 1.5 < min(east for east, _ in slow) < 26.0 - 3.7
    assert max(north for _, north in slow) > 12.0
