"""Whether the vehicle keeps its geofence: what is breached, since when, how often, and what a place would breach."""

from collections.abc import Sequence
from math import hypot, inf
from typing import Final

from vehicle_sim.autopilot.geofence import FencePlan, LocalFence
from vehicle_sim.parameters import FenceSettings, FenceType
from vehicle_sim.signals import Geodetic, Vector

_KINDS: Final = (FenceType.ALTITUDE, FenceType.CIRCLE, FenceType.AREAS)
_MOST_COUNTED: Final = 65500


class FenceWatch:
    """One vehicle's fence.

    Attributes to read: `plan`; `enabled`, the kinds that are watched; `breached`, those that are breached now; and of
    the latest breach `breached_s`, when it was, and `distance_m`, how far outside the vehicle is. `breaches` counts.
    """

    def __init__(self, settings: FenceSettings) -> None:
        """Watch what `settings` enable."""
        self.plan = FencePlan()
        self.breached = FenceType.NONE
        self.breached_s = 0.0
        self.breaches = 0
        self.distance_m = -inf
        self._settings = settings
        self.enabled = settings.kinds if settings.enabled else FenceType.NONE
        self._local: LocalFence | None = None
        self._origin: Geodetic | None = None
        self._again_m: dict[FenceType, float] = {}
        self._home: Vector = (0.0, 0.0, 0.0)
        self._safe_at: Vector = (0.0, 0.0, 0.0)
        self._safe_m = 0.0

    @property
    def is_there(self) -> bool:
        """Whether any kind of fence is set up, watched or not."""
        kinds = self._settings.kinds
        return bool(kinds & ~FenceType.AREAS) or (FenceType.AREAS in kinds and bool(self.plan.areas))

    def load(self, plan: FencePlan) -> None:
        """Watch another plan."""
        self.plan = plan
        self._local = self._origin = None
        self._safe_m = 0.0

    def configure(self, settings: FenceSettings) -> None:
        """Go by other settings; a changed switch or choice of kinds outweighs an earlier `switch`."""
        before, self._settings = self._settings, settings
        if (settings.enabled, settings.kinds) != (before.enabled, before.kinds):
            self.enabled = settings.kinds if settings.enabled else FenceType.NONE
            self._forget_all_but(self.enabled)
        self._safe_m = 0.0

    def switch(self, kinds: FenceType, *, on: bool) -> FenceType:
        """Watch more or fewer kinds until a setting changes; return those that are watched now."""
        self.enabled = self._settings.kinds & (self.enabled | kinds if on else self.enabled & ~kinds)
        self._forget_all_but(self.enabled)
        self._safe_m = 0.0
        return self.enabled

    def excess_m(self, kind: FenceType, place: Vector, home: Vector, origin: Geodetic) -> float:
        """Return how far outside of one kind of fence a place is; negative inside, whether it is watched or not."""
        if kind is FenceType.ALTITUDE:
            return home[2] - place[2] - self._settings.ceiling_m
        if kind is FenceType.CIRCLE:
            return hypot(place[0] - home[0], place[1] - home[1]) - self._settings.radius_m
        return self.local(origin).excess_m(place[0], place[1], is_union=self._settings.is_union)

    def local(self, origin: Geodetic) -> LocalFence:
        """Return the uploaded areas in the frame of `origin`."""
        if self._local is None or origin != self._origin:
            self._origin = origin
            self._local = LocalFence(self.plan.areas, origin)
        return self._local

    def forbids(self, place: Vector, home: Vector, origin: Geodetic) -> bool:
        """Whether the kinds that are watched forbid to be at a place."""
        return bool(self.enabled) and any(self.excess_m(kind, place, home, origin) >= 0.0 for kind in self._watched())

    def look(self, now_s: float, place: Vector, home: Vector, origin: Geodetic) -> FenceType:
        """Look at where the vehicle is (or will come to rest) and return the kinds that are freshly breached.

        A breach that goes on counts again where it has become worse by so much as the settings say.
        """
        if not self.enabled:
            return FenceType.NONE
        if home != self._home:
            self._home, self._safe_m = home, 0.0
        (north, east, down), (safe_n, safe_e, safe_d) = place, self._safe_at
        # Nothing can be breached before the vehicle has moved by its distance to the nearest border.
        if hypot(north - safe_n, east - safe_e, down - safe_d) < self._safe_m:
            return FenceType.NONE
        fresh, self.distance_m = FenceType.NONE, -inf
        for kind in self._watched():
            excess = self.excess_m(kind, place, home, origin)
            self.distance_m = max(self.distance_m, excess)
            if excess < 0.0:
                self.breached &= ~kind
                self._again_m.pop(kind, None)
            elif excess >= self._again_m.get(kind, 0.0):
                # Of the areas ArduPilot counts the first breach only.
                self._again_m[kind] = inf if kind is FenceType.AREAS else excess + self._settings.again_m
                self.breached |= kind
                self.breached_s = now_s
                self.breaches = min(self.breaches + 1, _MOST_COUNTED)
                fresh |= kind
        self._safe_at, self._safe_m = place, max(-self.distance_m, 0.0)
        return fresh

    def _watched(self) -> Sequence[FenceType]:
        return [kind for kind in _KINDS if kind in self.enabled]

    def _forget_all_but(self, kinds: FenceType) -> None:
        self.breached &= kinds
        self._again_m = {kind: excess for kind, excess in self._again_m.items() if kind in kinds}


def names(kinds: FenceType) -> str:
    """Return how ArduPilot names kinds of fence in its texts."""
    named = [text for kind, text in _NAMES if kind in kinds]
    *others, last = named or ["No"]
    listed = f"{', '.join(others)} and {last}" if others else last
    return f"{listed} fence{'s' if others else ''}"


_NAMES: Final = ((FenceType.ALTITUDE, "Max Alt"), (FenceType.CIRCLE, "Circle"), (FenceType.AREAS, "Polygon"))
