"""What a flight without a time law is at: which triangle to enter next, or where to stand, and when it is over."""

from collections.abc import Sequence
from dataclasses import dataclass

from mission.geometry.arrays import BoolArray
from mission.monitor.monitor import Whereabouts
from mission.planning.policy import Choice, Policy


@dataclass(frozen=True, eq=False)
class Loiter:
    """A region in which the vehicle stands still when it has come there for the mission's sake.

    Attributes:
        inside: (M,) its triangles.
        seconds: How long.
    """

    inside: BoolArray
    seconds: float


@dataclass(frozen=True)
class Order:
    """What to do now.

    Attributes:
        triangle: Where the vehicle is.
        enter: The triangle to enter next; None to stand in this one.
    """

    triangle: int
    enter: int | None


class Errand:
    """One flight's task, from wherever the vehicle is.

    Where a region asks for it, the vehicle stands still once it has entered, if that has brought the automaton on; a
    vehicle that is pushed out meanwhile comes back for the rest.

    Args:
        policy: What to do next.
        loiters: Where to stand still.
        laps: How often laps are flown; None until somebody says that it is enough, 0 where none are.
        recurrent: Whether laps are flown.
        final_stay_s: How long to stand at the end.

    Attributes:
        recurrent: Whether laps are flown.
        over: Whether all is done.
        sealed: Whether nothing can be completed from where the vehicle was last seen.
        returning: Whether the laps are over.
        cost: What is left, by the costs of the policy; infinite before anything is known.
    """

    def __init__(
        self, policy: Policy, loiters: Sequence[Loiter], *, laps: int | None, recurrent: bool, final_stay_s: float
    ) -> None:
        self._policy, self._loiters = policy, tuple(loiters)
        self._asked, self.recurrent, self._final_s = laps, recurrent, final_stay_s
        self._due_s: dict[int, float] = {}
        self._ways = [policy.visiting(region.inside) for region in self._loiters]
        self._last: Whereabouts | None = None
        self._seen_s: float | None = None
        self.over = self.sealed = self.returning = False
        self.cost = float("inf")

    def end_laps(self) -> bool:
        """Let the lap that is flown now be the last; False where none is."""
        if not self.recurrent or self.returning:
            return False
        self._asked = (0 if self._last is None else self._last.laps) + 1
        return True

    def order(self, where: Whereabouts, at_s: float, *, stands: bool) -> Order | None:
        """What to do.

        Args:
            where: Where the flight is.
            at_s: The vehicle's time.
            stands: Whether the vehicle stands still where it was to.

        Returns:
            None where nothing can be completed.
        """
        self._take_note(where)
        passed_s = 0.0 if self._seen_s is None or not stands else max(at_s - self._seen_s, 0.0)
        self._seen_s = at_s
        for number in list(self._due_s):
            if self._loiters[number].inside[where.triangle]:
                self._due_s[number] -= passed_s
            if self._due_s[number] <= 0.0:
                del self._due_s[number]
        choice = self._choice(where)
        self.sealed = choice is None
        if choice is None:
            return None
        if not self._due_s:
            self.cost = choice.cost
        if choice.enter is None and not self._due_s:
            self._final_s -= passed_s
            self.over |= self._final_s <= 0.0
        return Order(where.triangle, choice.enter)

    def _take_note(self, where: Whereabouts) -> None:
        last, self._last = self._last, where
        self.returning |= self.recurrent and self._asked is not None and where.laps >= self._asked
        if last is None or (last.state, last.due, last.laps) == (where.state, where.due, where.laps):
            return
        for number, region in enumerate(self._loiters):
            if region.inside[where.triangle] and not region.inside[last.triangle]:
                self._due_s[number] = region.seconds

    def _choice(self, where: Whereabouts) -> Choice | None:
        for number in list(self._due_s):
            choice = self._policy.onward(self._ways[number], where.triangle, where.state)
            if choice is not None:
                return choice
            del self._due_s[number]
        if self.returning:
            return self._policy.returning(where.triangle, where.state)
        return self._policy.completing(where.triangle, where.state, where.due)
