"""What is known of a flight in time: when each proposition holds for certain, and when it may."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final, NamedTuple

from mission.logic.formula.word import Letter
from mission.logic.timed.time_sets import (
    AFTER,
    BEFORE,
    NEVER,
    Span,
    Time,
    TimeSet,
    complement,
    intersection,
    joined,
    moved,
)

_MOMENT_S: Final = Fraction(1, 2)


class Known(NamedTuple):
    """When something holds for certain, and when it may; the same set where all is known."""

    must: TimeSet
    may: TimeSet


@dataclass(frozen=True)
class Behaviour:
    """Which propositions hold when, from 0 on: a part that is passed once, and one that repeats for ever.

    Attributes:
        known: Of each proposition, within the time from 0 up to ``end_s``.
        untold: When any other proposition may hold; at no other time does one.
        loop_s: When the part that repeats begins.
        end_s: When it is over for the first time: what is at ``end_s + t`` is as at ``loop_s + t``.

    Raises:
        ValueError: The part that repeats takes no time, or begins before 0.
    """

    known: Mapping[str, Known]
    untold: TimeSet
    loop_s: Time
    end_s: Time

    def __post_init__(self) -> None:
        if not 0 <= self.loop_s < self.end_s:
            raise ValueError("the part of a behaviour that repeats takes some time")

    def of(self, name: str) -> Known:
        """When a proposition holds."""
        return self.known.get(name, Known(NEVER, self.untold))

    def once_until(self, time_s: Time) -> "Behaviour":
        """The same behaviour, of which nothing repeats up to and including a time."""
        if self.loop_s > time_s:
            return self
        round_s = self.end_s - self.loop_s
        rounds = (time_s - self.loop_s) // round_s + 1
        loop: Span = (self.loop_s, BEFORE), (self.end_s, BEFORE)

        def again(times: TimeSet) -> TimeSet:
            inside = intersection(times, (loop,))
            if inside == (loop,):  # for ever: one span, however many rounds
                return joined([*times, (loop[1], moved(loop[1], rounds * round_s))])
            shifts = (k * round_s for k in range(1, rounds + 1)) if inside else ()
            return joined([*times, *((moved(a, by), moved(b, by)) for by in shifts for a, b in inside)])

        known = {name: Known(again(each.must), again(each.may)) for name, each in self.known.items()}
        later_s = rounds * round_s
        return Behaviour(known, again(self.untold), self.loop_s + later_s, self.end_s + later_s)


class Piece(NamedTuple):
    """A letter from one time to another, each of them in it or not.

    Attributes:
        span: When.
        must: The propositions that hold all the time.
        may: Those that hold now and then, if any does.
    """

    span: Span
    must: Letter
    may: Letter


def from_to(begin_s: Time, end_s: Time, *, closed: bool = False) -> Span:
    """The times from one on up to another, which is one of them if ``closed``."""
    return (begin_s, BEFORE), (end_s, AFTER if closed else BEFORE)


def behaviour_of(pieces: Sequence[Piece], loop_s: Time, end_s: Time) -> Behaviour:
    """The behaviour of pieces that ascend by their beginnings.

    Where pieces overlap all of them are true, and where there is none, nothing is known.

    Args:
        pieces: The last of them may go beyond the end.
        loop_s: When what repeats begins.
        end_s: When it is over for the first time.
    """
    whole: Span = (Fraction(0), BEFORE), (end_s, BEFORE)
    names = sorted(frozenset[str]().union(*(piece.may for piece in pieces)))
    told = _clipped((piece.span for piece in pieces), whole)
    known = {}
    for name in names:
        must = _clipped((piece.span for piece in pieces if name in piece.must), whole)
        never = _clipped((piece.span for piece in pieces if name not in piece.may), whole)
        known[name] = Known(must, complement(never, whole))
    return Behaviour(known, complement(told, whole), loop_s, end_s)


def staying(pieces: Sequence[Piece]) -> Behaviour:
    """The behaviour of pieces the last of which lasts for ever."""
    *before, last = pieces
    begin_s = last.span[0][0]
    end_s = _far(begin_s)
    return behaviour_of([*before, last._replace(span=(last.span[0], (end_s, BEFORE)))], begin_s + _MOMENT_S, end_s)


def so_far(pieces: Sequence[Piece], now_s: Time) -> Behaviour:
    """The behaviour of pieces the last of which lasts for ever, as far as it is known at a time."""
    now = now_s, AFTER
    begun = [piece for piece in pieces if piece.span[0] < now]
    ends = [min(piece.span[1], now) for piece in begun]
    if len(begun) == len(pieces):
        ends[-1] = now
    known = [piece._replace(span=(piece.span[0], end)) for piece, end in zip(begun, ends, strict=True)]
    return behaviour_of(known, now_s + _MOMENT_S, _far(now_s))


def _far(last_s: Time) -> Time:
    """After a time, as far as it is from the beginning: so a bound is not many times round what follows."""
    return 2 * last_s + 1


def _clipped(spans: Iterable[Span], whole: Span) -> TimeSet:
    return joined((max(begin, whole[0]), min(end, whole[1])) for begin, end in spans)
