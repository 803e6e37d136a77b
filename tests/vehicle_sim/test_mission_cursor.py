"""The position in a mission: orders of items, jumps, ends. Any list of items is left or goes on with time passing."""

from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle_sim.autopilot.cursor import MOST_STEPS, Cursor
from vehicle_sim.autopilot.mission_items import FOREVER, KINDS, Command, Kind, MissionItem

W, D, T, J = Command.WAYPOINT, Command.CHANGE_SPEED, Command.TURN, Command.JUMP
FLOWN = [command for command in Command if KINDS[command] is Kind.NAVIGATE]


def jump(target: int, repeats: int = FOREVER) -> MissionItem:
    return MissionItem(command=J, target=target, repeats=repeats)


def items(*commands: Command | MissionItem) -> tuple[MissionItem, ...]:
    return tuple(one if isinstance(one, MissionItem) else MissionItem(command=one) for one in commands)


def walk(cursor: Cursor, most: int = 50) -> list[tuple[int | None, list[int]]]:
    """Return the items flown, each with those beside it, up to the end or `most` of them."""
    walked: list[tuple[int | None, list[int]]] = []
    while len(walked) < most and cursor.advance():
        walked.append((cursor.current, list(cursor.beside)))
    return walked


def test_every_command_has_a_kind() -> None:
    assert set(KINDS) == set(Command)


def test_one_after_the_other() -> None:
    cursor = Cursor(items(W, D, T, W), first=0, beside=False)
    assert walk(cursor) == [(0, []), (1, []), (2, []), (3, [])]
    assert cursor.current == 3


def test_beside_the_following_leg_and_home_left_out() -> None:
    cursor = Cursor(items(W, D, W, D, T, W, D), first=1, beside=True)
    assert walk(cursor) == [(2, [1]), (5, [3, 4])]
    assert cursor.current == 5


@pytest.mark.parametrize("beside", [False, True])
def test_a_jump_is_followed_so_many_times(*, beside: bool) -> None:
    cursor = Cursor(items(W, W, jump(0, 2), W), first=0, beside=beside)
    assert [index for index, _ in walk(cursor)] == [0, 1, 0, 1, 0, 1, 3]
    cursor.restart()
    assert [index for index, _ in walk(cursor)] == [0, 1, 0, 1, 0, 1, 3]


def test_jumps_within_jumps() -> None:
    cursor = Cursor(items(W, W, jump(1, 1), jump(0, 1), W), first=0, beside=False)
    assert [index for index, _ in walk(cursor)] == [0, 1, 1, 0, 1, 4]


def test_what_a_jump_leads_over_runs_beside_its_target() -> None:
    cursor = Cursor(items(W, D, W, T, jump(1, 1), W), first=0, beside=True)
    assert walk(cursor) == [(0, []), (2, [1]), (2, [3, 1]), (5, [3])]


@pytest.mark.parametrize("target", [-1, 3, 99])
def test_a_jump_out_of_the_mission_ends_it(target: int) -> None:
    cursor = Cursor(items(W, jump(target), W), first=0, beside=False)
    assert [index for index, _ in walk(cursor)] == [0]


def test_the_item_ahead_is_seen_without_going_there() -> None:
    cursor = Cursor(items(W, D, jump(0, 1), Command.LAND), first=0, beside=False)
    assert cursor.advance()
    for _ in range(3):
        ahead = cursor.upcoming()
        assert ahead is not None
        assert ahead.command is W
    assert [index for index, _ in walk(cursor)] == [1, 0, 1, 3]
    assert cursor.upcoming() is None


def test_choosing_an_item_keeps_the_counts_until_they_are_forgotten() -> None:
    cursor = Cursor(items(W, jump(0, 1), W), first=0, beside=False)
    assert [index for index, _ in walk(cursor)] == [0, 0, 2]
    assert cursor.move_to(0)
    assert [index for index, _ in walk(cursor)] == [2]
    cursor.forget_jumps()
    assert cursor.move_to(0)
    assert [index for index, _ in walk(cursor)] == [0, 2]
    assert not cursor.move_to(99)
    assert cursor.current == 2


ANY = st.lists(
    st.one_of(
        st.sampled_from(FLOWN).map(lambda command: MissionItem(command=command)),
        st.sampled_from([D, T, Command.NOTHING]).map(lambda command: MissionItem(command=command)),
        st.builds(jump, st.integers(-1, 9), st.sampled_from([FOREVER, 0, 1, 3])),
    ),
    max_size=9,
)


class CountedItems(Sequence[MissionItem]):
    """Items that count how often one was looked at."""

    def __init__(self, held: Sequence[MissionItem]) -> None:
        self.held = held
        self.looks = 0

    def __len__(self) -> int:
        return len(self.held)

    def __getitem__(self, index: Any) -> Any:  # noqa: ANN401 - as a sequence's
        self.looks += 1
        return self.held[index]


@given(mission=ANY, beside=st.booleans(), first=st.integers(0, 1))
def test_no_list_of_items_hangs(mission: list[MissionItem], *, beside: bool, first: int) -> None:
    """Each step does bounded work, stops at something to run, and without endless jumps the end comes."""
    counted = CountedItems(mission)
    cursor = Cursor(counted, first=first, beside=beside)
    steps = 0
    while steps < 200:
        counted.looks = 0
        went_on = cursor.advance()
        assert counted.looks <= MOST_STEPS
        if not went_on:
            break
        steps += 1
        kind = mission[cursor.current or 0].kind
        assert kind is Kind.NAVIGATE or (kind is not Kind.JUMP and not beside)
        assert all(mission[index].kind in (Kind.CONDITION, Kind.ACT) for index in cursor.beside)
        assert cursor.current is not None
        assert cursor.current >= first
    if not any(item.kind is Kind.JUMP for item in mission):
        wanted = [
            index for index, item in enumerate(mission) if index >= first and (item.kind is Kind.NAVIGATE or not beside)
        ]
        assert steps == len(wanted)


def test_the_oracle_of_jumps() -> None:
    """Against an interpreter of another kind: a program counter, one instruction at a time."""
    mission = items(W, W, jump(0, 2), W, jump(1, 1), Command.LAND)
    done: dict[int, int] = {}
    at, visited = 0, []
    while at < len(mission):
        item = mission[at]
        if item.command is J and done.setdefault(at, 0) < item.repeats:
            done[at] += 1
            at = item.target
            continue
        if item.command is not J:
            visited.append(at)
        at += 1
    assert [index for index, _ in walk(Cursor(mission, first=0, beside=False))] == visited
