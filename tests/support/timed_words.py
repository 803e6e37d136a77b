"""Formulas with bounds on timed words, straight from the definition; nothing is shared with ``mission.logic.timed``.

Where letters change at whole times only and bounds are whole numbers, what holds at one moment between two whole times
holds at all of them. So time is a row of places: the place ``2 n`` is the time n, the place ``2 n + 1`` all the time
between n and n + 1.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from random import Random

from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import LONGEST_S, Bounds, Formula, rebuilt
from mission.logic.formula.word import Letter


@dataclass(frozen=True)
class TimedWord:
    """A letter for each place, the last ``round`` of which repeat for ever; both numbers of places are even."""

    letters: tuple[Letter, ...]
    round: int

    def at(self, place: int) -> Letter:
        size = len(self.letters)
        return self.letters[place if place < size else size - self.round + (place - size) % self.round]


def random_word(random: Random, names: tuple[str, ...], *, most: int = 6) -> TimedWord:
    letters, here = [], frozenset[str]()
    for _ in range(2 * random.randint(1, most)):
        if random.random() < 0.6:
            here = frozenset(name for name in names if random.random() < 0.5)
        letters.append(here)
    return TimedWord(tuple(letters), 2 * random.randint(1, len(letters) // 2))


def random_bounds(random: Random) -> tuple[int, int] | None:
    least = random.choice((0, 0, 1, 2, 5, 13))
    return None if random.random() < 0.25 else (least, least + random.choice((0, 1, 2, 4, 11)))


def random_timed(random: Random, operators: int, names: tuple[str, ...]) -> str:
    """The text of a formula of so many operators."""
    if operators == 0:
        return random.choice((*names, *names, "true", "false"))
    bounds = random_bounds(random)
    written = "" if bounds is None else f"[{bounds[0]},{bounds[1]}]"
    kind = random.choice(("!", "F", "F", "G", "G", "&", "|", "->", "<->", "U", "U", "R", "W", "M"))
    if kind in "!FG":
        return f"{kind}{written if kind != '!' else ''} ({random_timed(random, operators - 1, names)})"
    left = random.randint(0, operators - 1)
    sides = random_timed(random, left, names), random_timed(random, operators - 1 - left, names)
    return f"({sides[0]}) {kind}{written if kind in 'URWM' else ''} ({sides[1]})"


def random_window(random: Random) -> Bounds | None:
    """When a proposition counts: always, from one whole time to another, or from one on."""
    least = random.choice((0, 0, 1, 3, 8))
    most = random.choice((least, least + 1, least + 4, least + 15, LONGEST_S))
    return None if random.random() < 0.3 else (Fraction(least), Fraction(most))


def counting(formula: Formula, windows: dict[str, Bounds | None]) -> Formula:
    """A formula of which each proposition counts at its times only."""

    def build(node: Formula, operands: tuple[Formula, ...]) -> Formula:
        window = windows.get(node.name)
        return Formula(
            node.operator, operands, node.name, window if node.operator is Operator.PROPOSITION else node.bounds
        )

    return rebuilt(formula, build)


def counted(word: TimedWord, windows: dict[str, Bounds | None]) -> TimedWord:
    """The word in which each proposition is where it counts, and nowhere else; it repeats when nothing changes more."""
    last = 2 * max((int(time) for window in windows.values() for time in window or () if time < LONGEST_S), default=0)
    size = len(word.letters) + word.round * (last // word.round + 1)
    spans = {
        name: (0, math.inf) if window is None else (2 * window[0], 2 * window[1]) for name, window in windows.items()
    }
    endless = {name for name, window in windows.items() if window is not None and window[1] == LONGEST_S}
    letters = (
        frozenset(
            name for name in word.at(place) if spans[name][0] <= place and (place <= spans[name][1] or name in endless)
        )
        for place in range(size)
    )
    return TimedWord(tuple(letters), word.round)


Truth = Callable[[int], bool]
"""Whether something holds at a place."""


def holds(word: TimedWord, formula: Formula) -> bool:
    """Whether a timed word satisfies a formula at time 0, by the definition."""
    once, known = 2 * len(word.letters), dict[tuple[Formula, int], bool]()

    def at(node: Formula, place: int) -> bool:
        if place >= once:  # as some rounds before
            place -= word.round * (1 + (place - once) // word.round)
        if (node, place) not in known:
            known[node, place] = _holds(node, place, word, [partial(at, operand) for operand in node.operands])
        return known[node, place]

    return at(formula, 0)


def _holds(node: Formula, place: int, word: TimedWord, operands: list[Truth]) -> bool:
    """One line of the definition."""
    least, most = (0, len(word.letters) * 2) if node.bounds is None else (int(bound) for bound in node.bounds)
    window = range(place + 2 * least, place + 2 * most + 1)
    before = range(place, place + 2 * most + 1)
    first, last = (operands[0], operands[-1]) if operands else (lambda _: False, lambda _: False)
    lines: dict[Operator, Callable[[], bool]] = {
        Operator.TRUE: lambda: True,
        Operator.FALSE: lambda: False,
        Operator.PROPOSITION: lambda: node.name in word.at(place),
        Operator.NOT: lambda: not first(place),
        Operator.AND: lambda: all(each(place) for each in operands),
        Operator.OR: lambda: any(each(place) for each in operands),
        Operator.IMPLIES: lambda: not first(place) or last(place),
        Operator.IFF: lambda: first(place) == last(place),
        Operator.EVENTUALLY: lambda: any(first(later) for later in window),
        Operator.ALWAYS: lambda: all(first(later) for later in window),
        Operator.UNTIL: lambda: _until(first, last, window, place),
        Operator.WEAK_UNTIL: lambda: _until(first, last, window, place) or all(first(later) for later in before),
        Operator.RELEASE: lambda: not _until(_denied(first), _denied(last), window, place),
        Operator.STRONG_RELEASE: lambda: (
            not _until(_denied(first), _denied(last), window, place) and any(first(later) for later in before)
        ),
    }
    return lines[node.operator]()


def _until(left: Truth, right: Truth, window: range, place: int) -> bool:
    for goal in window:
        # A moment between two whole times has moments of the same place before it.
        last = goal + (goal % 2 if goal > place else 0)
        if right(goal) and all(left(each) for each in range(place, last)):
            return True
    return False


def _denied(side: Truth) -> Truth:
    return lambda later: not side(later)
