"""Counts how often the loop of a recurrent run has been flown."""

from itertools import groupby

from mission.geometry.regions import Labelling


class LapCounter:
    """Counts laps by the labels of the loop.

    A lap is over when the vehicle has entered, in order, triangles with each label that the loop spells (equal
    neighbours once, round the end of the loop too; triangles without a label do not count). So neither a detour nor
    a triangle more or less at a border changes the count. Of a loop without labels, the triangles themselves count.

    Args:
        suffix: The triangles of the loop, in order, at least one.
        labelling: The labels of the domain.
    """

    def __init__(self, suffix: tuple[int, ...], labelling: Labelling) -> None:
        letters = labelling.letter_of.tolist()
        spelled = [letters[t] for t in suffix if labelling.label(t)]
        self._key = {t: letter if spelled else t for t, letter in enumerate(letters)}
        marks = [key for key, _ in groupby(spelled or suffix)]
        self._marks = tuple(marks[:-1] if len(marks) > 1 and marks[0] == marks[-1] else marks)
        self._next = 0
        self.laps = 0

    def enter(self, triangle: int) -> None:
        """Take note that the vehicle has entered a triangle."""
        if self._key[triangle] != self._marks[self._next]:
            return
        self._next += 1
        if self._next == len(self._marks):
            self._next = 0
            self.laps += 1
