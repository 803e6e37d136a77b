"""Sets of times as unions of intervals, with ends that belong to them or do not; all arithmetic is exact.

An end is a cut between times: ``(t, BEFORE)`` lies just before t, ``(t, AFTER)`` just after it. So ``[1, 2)`` is the
span from ``(1, BEFORE)`` to ``(2, BEFORE)``, and cuts are compared as pairs. A set is a tuple of spans, ascending, none
empty, with time between any two.
"""

from collections.abc import Iterable
from fractions import Fraction
from heapq import merge
from typing import Final

BEFORE: Final = 0
AFTER: Final = 1

Time = Fraction | int
"""Of one unit within one set: seconds, or whole parts of them."""

Cut = tuple[Time, int]
Span = tuple[Cut, Cut]
TimeSet = tuple[Span, ...]

NEVER: Final[TimeSet] = ()


def joined(spans: Iterable[Span]) -> TimeSet:
    """The union of spans that ascend by their beginnings; those that are empty are left out."""
    found: list[Span] = []
    for begin, end in spans:
        if begin >= end:
            continue
        if found and begin <= found[-1][1]:
            found[-1] = found[-1][0], max(found[-1][1], end)
        else:
            found.append((begin, end))
    return tuple(found)


def union(*sets: TimeSet) -> TimeSet:
    """The times in any of the sets."""
    return joined(merge(*sets))


def complement(times: TimeSet, whole: Span) -> TimeSet:
    """The times of a span that are not in a set, all of which is in the span."""
    cuts = [whole[0], *(cut for span in times for cut in span), whole[1]]
    return joined(zip(cuts[::2], cuts[1::2], strict=True))


def intersection(first: TimeSet, second: TimeSet) -> TimeSet:
    """The times in both sets."""
    found: list[Span] = []
    i = j = 0
    while i < len(first) and j < len(second):
        begin, end = max(first[i][0], second[j][0]), min(first[i][1], second[j][1])
        if begin < end:
            found.append((begin, end))
        if first[i][1] <= second[j][1]:
            i += 1
        else:
            j += 1
    return tuple(found)


def moved(cut: Cut, by: Time) -> Cut:
    """A cut at another time."""
    return cut[0] + by, cut[1]


def whole(time: Time, unit: int) -> int:
    """A time, which is a multiple of a part of a second, as their number: of ``unit`` such parts in a second."""
    return time.numerator * (unit // time.denominator)


def in_whole(times: TimeSet, unit: int) -> TimeSet:
    """A set in such parts."""
    return tuple(((whole(a, unit), begins), (whole(b, unit), ends)) for (a, begins), (b, ends) in times)


def contains(times: TimeSet, time: Time) -> bool:
    """Whether a time is in a set."""
    return any(begin <= (time, BEFORE) and (time, AFTER) <= end for begin, end in times)
