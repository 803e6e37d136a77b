"""Counts how often the loop of a recurrent run, or any round that an automaton accepts, has been flown."""

from copy import copy
from itertools import groupby

from mission.geometry.regions import Labelling
from mission.logic.automata.rabin import DEAD, Rabin
from mission.logic.formula.word import Letter


class LapCounter:
    """Counts laps by the labels of the loop.

    A lap is over when the vehicle has entered, in order, triangles with each label that the loop spells (equal
    neighbours once, round the end of the loop too; triangles without a label do not count), and then, where the loop
    begins in a region, that region again. So neither a detour nor a triangle more or less at a border changes the
    count. In a loop with one label the places without one count as well; in one that spells nothing else, triangles do.

    Args:
        suffix: The triangles of the loop, in order, at least one.
        labelling: The labels of the domain.
        begun: Whether a lap that was begun before is completed on the way to the loop: -1 laps are over until that is
            come to.
    """

    def __init__(self, suffix: tuple[int, ...], labelling: Labelling, *, begun: bool = False) -> None:
        letters: list[int] = labelling.letter_of.tolist()
        spelled = [letters[t] for t in suffix if labelling.label(t)]
        if len(set(spelled)) > 1:
            self._key = dict(enumerate(letters))
        elif len({letters[t] for t in suffix}) > 1:
            self._key, spelled = dict(enumerate(letters)), [letters[t] for t in suffix]
        else:
            self._key, spelled = {t: t for t in range(len(letters))}, list(suffix)
        marks = [key for key, _ in groupby(spelled)]
        marks = marks[:-1] if len(marks) > 1 and marks[0] == marks[-1] else marks
        self._closes = self._key[suffix[0]] == marks[0]
        self._marks = (*marks, marks[0]) if self._closes else tuple(marks)
        self._label = {self._key[triangle]: labelling.label(triangle) for triangle in range(len(letters))}
        self._next = 0
        self._begun = begun
        self.laps = -1 if begun else 0

    @property
    def due(self) -> tuple[Letter, ...] | None:
        """The labels that the lap under way has not met, without what closes it; None where none is under way."""
        if self._begun:
            return ()
        if self._next == 0:
            return None
        return tuple(self._label[mark] for mark in self._marks[self._next : len(self._marks) - int(self._closes)])

    def enter(self, triangle: int) -> None:
        """Take note that the vehicle has entered a triangle."""
        if self._key[triangle] != self._marks[self._next]:
            return
        if self._begun:
            self._begun, self.laps = False, 0
        self._next += 1
        if self._next == len(self._marks):
            # What closes one lap begins the next one.
            self._next = int(self._closes)
            self.laps += 1


class RoundCounter:
    """Counts rounds by the marks of a deterministic automaton, whatever way they were flown.

    A round of a pair of its condition is over when each mark that must come again and again has come; a mark that must
    not makes it begin anew.

    Args:
        automaton: Over the numbers of the letters of the domain.
        counted: The state, what is due and the rounds of each pair, where some have been counted already.

    Attributes:
        due: For each pair the marks that its present round has not met, as bits; all of them at its beginning.
    """

    def __init__(self, automaton: Rabin, counted: tuple[int, tuple[int, ...], tuple[int, ...]] | None = None) -> None:
        begin = int(automaton.initial), tuple(inf for _, inf in automaton.pairs), (0,) * len(automaton.pairs)
        self._automaton = automaton
        self._state, self.due, rounds = counted or begin
        self._rounds = [*rounds]

    def copy(self) -> "RoundCounter":
        """Another one that has counted the same."""
        return RoundCounter(self._automaton, (self._state, self.due, tuple(self._rounds)))

    @property
    def state(self) -> int:
        """Where the automaton is; -1 where it has no run on what was read."""
        return self._state

    @property
    def laps(self) -> int:
        """How many rounds of a pair are over, of that which has most."""
        return max(self._rounds, default=0)

    def read(self, letter: int) -> None:
        """Go on by one letter, an index into the alphabet."""
        if self._state == DEAD:
            return
        marks = int(self._automaton.marks[self._state, letter])
        self._state = int(self._automaton.targets[self._state, letter])
        due = list(self.due)
        for pair, (fin, inf) in enumerate(self._automaton.pairs):
            due[pair] = inf if marks & fin else due[pair] & ~marks
            if not due[pair] and not marks & fin:
                self._rounds[pair] += 1
                due[pair] = inf
        self.due = tuple(due)


class Laps:
    """Counts the laps of a flight by one plan, those before it and one that was under way then included.

    Args:
        automaton: Deterministic, of what the flight satisfies, over the numbers of the letters.
        labelling: The labels of the domain.
        suffix: The triangles of the planned loop; empty where the flight ends in a stay.
        any_way: Whether any round that the automaton accepts is a lap, and not that of ``suffix`` alone.
        before: How many laps were flown before, with the one that is under way when this begins.
        begun: Whether one is: it is completed on the way to the loop, or where there is none, in the end.

    Attributes:
        rounds: What the automaton has read.
    """

    def __init__(
        self,
        automaton: Rabin,
        labelling: Labelling,
        *,
        suffix: tuple[int, ...] = (),
        any_way: bool = False,
        before: int = 0,
        begun: bool = False,
    ) -> None:
        self._labelling, self._any_way, self._before, self._begun = labelling, any_way, before, begun
        self.rounds = RoundCounter(automaton)
        self._loop = LapCounter(suffix, labelling, begun=begun) if suffix else None

    def copy(self) -> "Laps":
        """Another one that has counted the same."""
        other = copy(self)
        other.rounds, other._loop = self.rounds.copy(), copy(self._loop)  # noqa: SLF001 - its own
        return other

    def enter(self, triangle: int, *, spells: bool = True) -> None:
        """Take note that the vehicle has entered a triangle, and whether its label is read."""
        if spells:
            self.rounds.read(int(self._labelling.letter_of[triangle]))
        if self._loop is not None:
            self._loop.enter(triangle)

    def over(self, *, satisfied: bool, sure: bool = True) -> int:
        """How many are over.

        Args:
            satisfied: Whether the mission is, by which one that was begun is over where there is no loop.
            sure: Whether all that was entered is known: otherwise those count that led round the loop, for rounds of
                the automaton may have been broken by what is not known.
        """
        if self._loop is None:
            return self._before - int(self.ends and not satisfied)
        return self._before + (self.rounds.laps if self._any_way and sure else self._loop.laps)

    @property
    def ends(self) -> bool:
        """Whether a lap that was begun before is over once the mission is satisfied."""
        return self._begun and self._loop is None

    @property
    def due(self) -> tuple[Letter, ...] | None:
        """The labels that the lap under way has not met, as ``LapCounter.due``."""
        if self._loop is None:
            return () if self._begun else None
        return None if self._any_way else self._loop.due


def laps_text(flown: int, asked: int | None) -> str:
    """``1 of 2 laps were flown``; ``asked`` is None where they were to go on until somebody said that it was enough."""
    if asked is not None and flown <= asked:
        return f"{flown} of {asked} laps were flown"
    told = "1 lap was flown" if flown == 1 else f"{flown} laps were flown"
    return told if asked is None else f"{told}, {asked} {'was' if asked == 1 else 'were'} asked for"
