"""Settings that keep the vehicle within bounds: geofence, rally points, limits of wind."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, IntFlag, auto
from math import inf
from typing import Final

from vehicle_sim.parameters.actions import Action
from vehicle_sim.parameters.store import ParameterStore


class FenceType(IntFlag):
    """Kinds of fence; the values are the bits of ArduPilot's FENCE_TYPE.

    ALTITUDE is a ceiling above home, CIRCLE a radius around home, AREAS are the uploaded polygons and circles.
    """

    NONE = 0
    ALTITUDE = 1
    CIRCLE = 2
    AREAS = 4


ALL_FENCES: Final = FenceType.ALTITUDE | FenceType.CIRCLE | FenceType.AREAS


@dataclass(frozen=True, slots=True, kw_only=True)
class FenceSettings:
    """The geofence: which kinds there are, how far they reach (m), what a breach leads to.

    Attributes:
        enabled: Whether the kinds are watched from the start.
        kinds: The kinds that there are.
        reports: Whether a breach is said at all.
        action: What a breach leads to.
        ceiling_m: Height above home.
        radius_m: Distance from home.
        margin_m: How far inside of the border automatic flight stays.
        is_union: Whether one inclusion area is enough where there are several.
        locks_mode: Whether the pilot is kept from changing the mode before the breach is over.
        slows_down: Whether velocity setpoints are slowed down so that they end at the margin.
        predicts: Whether the place where the vehicle would come to rest is watched instead of where it is.
        give_up_m: Further outside than this the vehicle lands instead.
        again_m: So much further out a breach counts as a new one.
    """

    enabled: bool
    kinds: FenceType
    reports: bool
    action: Action
    ceiling_m: float
    radius_m: float
    margin_m: float
    is_union: bool
    locks_mode: bool
    slows_down: bool
    predicts: bool
    give_up_m: float
    again_m: float


class RallyChoice(Enum):
    """Where a return may lead: home alone, the nearest of home and rally points, or the nearest rally point."""

    HOME = auto()
    NEAREST = auto()
    RALLY = auto()


@dataclass(frozen=True, slots=True, kw_only=True)
class RallySettings:
    """Which rally points a return may choose.

    Attributes:
        choice: What it chooses from.
        limit_m: Points further away than this are left out.
        names_height: Whether the point's height is the height of the way back; else that height is added to it.
    """

    choice: RallyChoice
    limit_m: float
    names_height: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class WindSettings:
    """Wind speeds (m/s, infinite: never) that are warned of and acted on, and the action."""

    warning_m_s: float
    limit_m_s: float
    action: Action


_FENCE: Final[Mapping[int, Action]] = {
    0: Action.NOTHING,
    1: Action.RETURN,
    2: Action.LAND,
    3: Action.RETRACE,
    4: Action.BRAKE,
    5: Action.LAND,
}
_LIMIT: Final[Mapping[int, Action]] = {
    2: Action.HOLD,
    3: Action.RETURN,
    4: Action.TERMINATE,
    5: Action.LAND,
}
_LOCKS_MODE, _IS_UNION = 1, 2
_STOPS_AT_FENCE = 1
_GIVE_UP_M, _AGAIN_M = 100.0, 20.0
_RALLY_TYPES: Final[Mapping[int, RallyChoice]] = {
    0: RallyChoice.NEAREST,
    1: RallyChoice.RALLY,
    3: RallyChoice.NEAREST,
}


def _if_positive(value: float) -> float:
    return value if value > 0.0 else inf


def ardupilot_fence(store: ParameterStore) -> FenceSettings:
    """Return what ArduPilot's FENCE_* and AVOID_ENABLE amount to."""
    options = int(store["FENCE_OPTIONS"])
    return FenceSettings(
        enabled=store["FENCE_ENABLE"] > 0.0,
        kinds=FenceType(int(store["FENCE_TYPE"])),
        reports=True,
        action=_FENCE[int(store["FENCE_ACTION"])],
        ceiling_m=store["FENCE_ALT_MAX"],
        radius_m=store["FENCE_RADIUS"],
        margin_m=store["FENCE_MARGIN"],
        is_union=bool(options & _IS_UNION),
        locks_mode=bool(options & _LOCKS_MODE),
        slows_down=bool(int(store["AVOID_ENABLE"]) & _STOPS_AT_FENCE),
        predicts=False,
        give_up_m=_GIVE_UP_M,
        again_m=_AGAIN_M,
    )


def px4_fence(store: ParameterStore) -> FenceSettings:
    """Return what PX4's GF_* amount to."""
    ceiling_m, radius_m = store["GF_MAX_VER_DIST"], store["GF_MAX_HOR_DIST"]
    kinds = FenceType.AREAS
    kinds |= FenceType.ALTITUDE if ceiling_m > 0.0 else FenceType.NONE
    kinds |= FenceType.CIRCLE if radius_m > 0.0 else FenceType.NONE
    choice = int(store["GF_ACTION"])
    return FenceSettings(
        enabled=choice > 0,
        kinds=kinds,
        reports=choice > 0,
        action=_LIMIT.get(choice, Action.NOTHING),
        ceiling_m=_if_positive(ceiling_m),
        radius_m=_if_positive(radius_m),
        margin_m=0.0,
        is_union=False,
        locks_mode=False,
        slows_down=False,
        predicts=store["GF_PREDICT"] > 0.0,
        give_up_m=inf,
        again_m=inf,
    )


def ardupilot_rally(store: ParameterStore) -> RallySettings:
    """Return what ArduPilot's RALLY_* amount to."""
    return RallySettings(
        choice=RallyChoice.NEAREST if store["RALLY_INCL_HOME"] > 0.0 else RallyChoice.RALLY,
        limit_m=_if_positive(1000.0 * store["RALLY_LIMIT_KM"]),
        names_height=True,
    )


def px4_rally(store: ParameterStore) -> RallySettings:
    """Return what PX4's RTL_TYPE amounts to without a landing in the mission."""
    choice = _RALLY_TYPES.get(int(store["RTL_TYPE"]), RallyChoice.HOME)
    return RallySettings(choice=choice, limit_m=inf, names_height=False)


NO_WIND_LIMIT: Final = WindSettings(warning_m_s=inf, limit_m_s=inf, action=Action.NOTHING)
"""ArduCopter knows no limit of wind."""


def px4_wind(store: ParameterStore) -> WindSettings:
    """Return what PX4's COM_WIND_* amount to."""
    return WindSettings(
        warning_m_s=_if_positive(store["COM_WIND_WARN"]),
        limit_m_s=_if_positive(store["COM_WIND_MAX"]),
        action=_LIMIT.get(int(store["COM_WIND_MAX_ACT"]), Action.NOTHING),
    )
