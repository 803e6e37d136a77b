"""Counts how often the loop of a recurrent run has been flown."""

from itertools import groupby

from mission.geometry.regions import Labelling


class LapCounter:
    """Counts laps by the labels of the loop.

    A lap is over when the vehicle has entered, in order, triangles with each label that the loop spells (equal
    neighbours once, round the end of the loop too; triangles without a label do not count), and then, where the loop
    begins in a region, that region again. So neither a detour nor a triangle more or less at a border changes the
    count. In a loop with one label the places without one count as well; in one that spells nothing else, triangles do.

    Args:
        suffix: The triangles of the loop, in order, at least one.
        labelling: The labels of the domain.
    """

    def __init__(self, suffix: tuple[int, ...], labelling: Labelling) -> None:
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
        self._next = 0
        self.laps = 0

    def enter(self, triangle: int) -> None:
        """Take note that the vehicle has entered a triangle."""
        if self._key[triangle] != self._marks[self._next]:
            return
        self._next += 1
        if self._next == len(self._marks):
            # What closes one lap begins the next one.
            self._next = int(self._closes)
            self.laps += 1
