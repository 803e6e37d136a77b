"""Guards: Boolean functions of propositions on the edges of automata, as short disjunctions of cubes."""

from dataclasses import dataclass
from functools import reduce
from operator import and_

from mission.logic.formula.syntax import Formula, conjunction, disjunction, negation, proposition

Cube = tuple[int, int]
"""A conjunction of literals: the bits of the propositions that hold, and of those that do not."""


@dataclass(frozen=True)
class Guard:
    """A Boolean function of propositions.

    Attributes:
        propositions: The names that the bits of the cubes stand for, bit 0 first.
        cubes: The function is their disjunction: none is ``false``, ``(0, 0)`` is ``true``.

    Raises:
        ValueError: A cube speaks of a proposition that does not exist, or contradicts itself.
    """

    propositions: tuple[str, ...]
    cubes: tuple[Cube, ...]

    def __post_init__(self) -> None:
        for holds, fails in self.cubes:
            if holds & fails or not 0 <= holds | fails < 1 << len(self.propositions):
                raise ValueError(f"no cube over {len(self.propositions)} propositions: {holds:#b}, {fails:#b}")

    def allows(self, letter: frozenset[str]) -> bool:
        """Whether the function is true where exactly the propositions of ``letter`` hold."""
        bits = sum(1 << bit for bit, name in enumerate(self.propositions) if name in letter)
        return self.allows_bits(bits)

    def allows_bits(self, bits: int) -> bool:
        """The same for a letter given as the bits of what holds."""
        return any(not holds & ~bits and not fails & bits for holds, fails in self.cubes)

    def formula(self) -> Formula:
        """The guard as a formula without temporal operators; literals that all cubes share stand in front."""
        if not self.cubes:
            return disjunction()
        shared = (reduce(and_, (cube[0] for cube in self.cubes)), reduce(and_, (cube[1] for cube in self.cubes)))
        if len(self.cubes) == 1:
            return self._cube(shared)
        rest = disjunction(*(self._cube((holds & ~shared[0], fails & ~shared[1])) for holds, fails in self.cubes))
        return conjunction(self._cube(shared), rest) if any(shared) else rest

    def _cube(self, cube: Cube) -> Formula:
        holds, fails = cube
        literals: list[Formula] = []
        for bit, name in enumerate(self.propositions):
            if holds >> bit & 1:
                literals.append(proposition(name))
            elif fails >> bit & 1:
                literals.append(negation(proposition(name)))
        return conjunction(*literals)

    def __str__(self) -> str:
        return str(self.formula())
