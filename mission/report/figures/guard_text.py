"""Guards as they are written at the arrows of an automaton: in full, shortened to a domain, or by a key."""

from collections.abc import Sequence

from mission.logic.automata.guards import Cube, Guard
from mission.report.figures.canvas import plain

LONGEST_LINE = 24
LONGEST_KEY_LINE = 100
LONGEST_WITHOUT_KEY = 6
SIGNS = str.maketrans({"!": "¬", "&": "∧", "|": "∨"})


def shortened(guard: Guard, letters: Sequence[frozenset[str]]) -> Guard:
    """A guard that allows the same of these letters with fewer literals; literals that forbid are dropped first.

    Where regions are apart, ``a & !b & !c`` becomes ``a``.
    """
    allowed = [letter for letter in letters if guard.allows(letter)]
    others = [letter for letter in letters if not guard.allows(letter)]
    if not allowed:
        return guard
    cubes = [_shortest(cube, guard.propositions, others) for cube in guard.cubes]
    kept: list[Cube] = []
    for cube in dict.fromkeys(cubes):
        single = Guard(guard.propositions, (cube,))
        so_far = Guard(guard.propositions, tuple(kept))
        if any(single.allows(letter) and not so_far.allows(letter) for letter in allowed):
            kept.append(cube)
    return Guard(guard.propositions, tuple(kept))


def written(guard: Guard) -> str:
    """A guard in the signs of mathematics, in lines."""
    return "\n".join(_broken(_signs(guard), LONGEST_LINE))


def in_lines(formula: str) -> str:
    """A formula as it is written, in lines."""
    return "\n".join(_broken(plain(formula), LONGEST_KEY_LINE))


def keyed(guards: Sequence[Guard]) -> tuple[list[str], list[str]]:
    """Short names for all but the shortest guards, and the lines that explain the names."""
    key: dict[str, str] = {}
    names = []
    for guard in guards:
        text = _signs(guard)
        short = len(text) <= LONGEST_WITHOUT_KEY
        names.append(text if short else key.setdefault(text, f"g{len(key) + 1}"))
    lines = []
    for text, name in key.items():
        first, *rest = _broken(text, LONGEST_KEY_LINE)
        lines += [f"{name}:  {first}", *(f"         {line}" for line in rest)]
    return names, lines


def _shortest(cube: Cube, propositions: tuple[str, ...], others: Sequence[frozenset[str]]) -> Cube:
    """Drop literals for as long as the cube still allows none of the other letters."""
    holds, fails = cube
    for bit in range(len(propositions)):
        fewer = (holds, fails & ~(1 << bit))
        if not _allows_any(fewer, propositions, others):
            holds, fails = fewer
    for bit in range(len(propositions)):
        fewer = (holds & ~(1 << bit), fails)
        if not _allows_any(fewer, propositions, others):
            holds, fails = fewer
    return holds, fails


def _allows_any(cube: Cube, propositions: tuple[str, ...], letters: Sequence[frozenset[str]]) -> bool:
    guard = Guard(propositions, (cube,))
    return any(guard.allows(letter) for letter in letters)


def _signs(guard: Guard) -> str:
    return plain(str(guard)).translate(SIGNS)


def _broken(text: str, longest: int) -> list[str]:
    """Break a guard, or a formula, before its operators."""
    lines: list[str] = []
    for sign in "∧∨&|":
        text = text.replace(f" {sign} ", f" \n{sign} ")
    for word in text.split("\n"):
        if lines and len(lines[-1]) + len(word) <= longest:
            lines[-1] += word
        else:
            lines.append(word)
    return [line.strip() for line in lines]
