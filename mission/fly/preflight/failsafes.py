"""What the vehicle does by itself when something is lost: setpoints, ground station, sticks, charge; and its fence.

Meanings of values: ArduCopter's and PX4's parameter references.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from mission.fly.preflight.rows import ARDUPILOT, PX4, Asked, Judgement, Level, Row, Setting, Told, worst
from mission.spec.finding import listed

_GO, _CAUTION, _NO_GO = Level.GO, Level.CAUTION, Level.NO_GO
_FALLS: Final = "it would fall: choose an action that flies"
_RETURN: Final = (_GO, "returns, straight and at its own height", "")
_LAND: Final = (_GO, "lands", "")
_HOLD: Final = (_GO, "holds", "")
_ELSE: Final = (_GO, "acts by an action that is not known here", "")

Action = tuple[Level, str, str]


@dataclass(frozen=True)
class _Reaction:
    """What a parameter says is done: its level, in plain words, and what to do about that, by value."""

    setting: Setting
    actions: Mapping[str, Mapping[int, Action]]

    def judge(self, told: Told) -> Judgement:
        """What is thought of the action that is chosen."""
        value = self.setting.of(told)
        if value is None:
            missing = self.setting.names.get(told.autopilot)
            return Judgement(Level.UNKNOWN, f"{missing[-1][0]} is not known") if missing else Judgement(_GO, "")
        level, words, advice = self.actions[told.autopilot].get(int(value.value), _ELSE)
        return Judgement(level, f"{words} ({value})", advice and f"{value.name}: {advice}")


def _parameter(ardupilot: str | None, px4: str | None, unit: float = 1.0) -> Setting:
    pairs = ((ARDUPILOT, ardupilot), (PX4, px4))
    return Setting({autopilot: ((name, unit),) for autopilot, name in pairs if name is not None})


_PX4_ON_LOSS: Final[Mapping[int, Action]] = {
    0: (_CAUTION, "nothing", "1 holds, 2 returns, 3 lands"),
    1: _HOLD,
    2: _RETURN,
    3: _LAND,
    5: (_NO_GO, "terminates the flight", _FALLS),
    6: (_NO_GO, "disarms", _FALLS),
}
"""Of its ground station (NAV_DLL_ACT) and of its sticks (NAV_RCL_ACT) alike."""

_LINK_LOSS: Final = _Reaction(
    _parameter("FS_GCS_ENABLE", "NAV_DLL_ACT"),
    {
        ARDUPILOT: {
            0: (_CAUTION, "nothing, it hovers until its battery is low", "5 lands, 1 returns"),
            1: _RETURN,
            2: _RETURN,
            3: _RETURN,
            4: _RETURN,
            5: _LAND,
            6: _RETURN,
            7: _HOLD,
        },
        PX4: _PX4_ON_LOSS,
    },
)
_STICKS_LOSS: Final = _Reaction(
    _parameter("FS_THR_ENABLE", "NAV_RCL_ACT"),
    {
        ARDUPILOT: {
            0: (_CAUTION, "nothing", "1 returns, 3 lands"),
            1: _RETURN,
            2: _RETURN,
            3: _LAND,
            4: _RETURN,
            5: _RETURN,
            6: _RETURN,
            7: _HOLD,
        },
        PX4: _PX4_ON_LOSS,
    },
)
_ON_LOW: Final[Mapping[int, Action]] = {
    0: (_CAUTION, "warns only", "1 lands, 2 returns"),
    1: _LAND,
    2: _RETURN,
    3: _RETURN,
    4: _RETURN,
    5: (_NO_GO, "terminates the flight", _FALLS),
    6: _RETURN,
    7: _HOLD,
}
_LOW_BATTERY: Final = (
    _Reaction(_parameter("BATT_FS_LOW_ACT", None), {ARDUPILOT: _ON_LOW}),
    _Reaction(_parameter("BATT_FS_CRT_ACT", None), {ARDUPILOT: _ON_LOW}),
    _Reaction(
        _parameter(None, "COM_LOW_BAT_ACT"),
        {
            PX4: {
                0: (_CAUTION, "warns only", "3 returns, and lands in an emergency"),
                1: _RETURN,
                2: _LAND,
                3: _RETURN,
            }
        },
    ),
)
_SETPOINT_LOSS: Final = _Reaction(
    _parameter(None, "COM_OBL_RC_ACT"),
    {
        PX4: {
            0: (_GO, "leaves it to the sticks in Position mode, or to what is done where there are none", ""),
            1: (_CAUTION, "leaves it to the sticks in Altitude mode, where it drifts", "5 holds, 4 lands"),
            2: (_CAUTION, "leaves it to the sticks in Stabilized mode, where it drifts", "5 holds, 4 lands"),
            3: _RETURN,
            4: _LAND,
            5: _HOLD,
            6: (_NO_GO, "terminates the flight", _FALLS),
            7: (_NO_GO, "disarms", _FALLS),
        }
    },
)
_SILENCE: Final = _parameter("GUID_TIMEOUT", "COM_OF_LOSS_T")
_LEAST_SETPOINTS: Final = 10
_SHORT_S, _LONG_S = 0.5, 5.0
"""The first is the gap in which the trajectory waits; after the second, a vehicle without this program is far away."""

_WATCHED: Final = Setting({ARDUPILOT: (("MAV_GCS_SYSID", 1.0), ("SYSID_MYGCS", 1.0))})


def _setpoints(asked: Asked, told: Told) -> Judgement:
    """How long the vehicle goes on without setpoints, and what it does then."""
    timeout = _SILENCE.of(told)
    if timeout is None:
        missing = _SILENCE.names[told.autopilot][0][0]
        return worst((Judgement(Level.UNKNOWN, f"{missing} is not known"), _SETPOINT_LOSS.judge(told)))
    quiet_s = timeout.value
    figure = f"goes on for {quiet_s:g} s and {quiet_s * asked.speed_m_s:.0f} m without setpoints ({timeout.name})"
    if quiet_s < _LEAST_SETPOINTS * asked.setpoint_s:
        level, advice = _NO_GO, f"setpoints come each {asked.setpoint_s:.2g} s: set {timeout.name} to 1 s"
    elif quiet_s < _SHORT_S:
        level, advice = _CAUTION, f"links pause for longer: set {timeout.name} to 1 s"
    elif quiet_s > _LONG_S:
        level, advice = _CAUTION, f"set {timeout.name} to 3 s or less"
    else:
        level, advice = _GO, ""
    return worst((Judgement(level, figure, advice), _SETPOINT_LOSS.judge(told)))


def _link_loss(asked: Asked, told: Told) -> Judgement:
    """What is done when this program is gone, and whether the vehicle would notice."""
    reaction, watched = _LINK_LOSS.judge(told), _WATCHED.of(told)
    if watched is None or int(watched.value) == asked.system_id:
        return reaction
    advice = f"set {watched.name} to {asked.system_id}"
    return worst((reaction, Judgement(_CAUTION, f"it watches another one than this ({watched})", advice)))


def _low_battery(_asked: Asked, told: Told) -> Judgement:
    return worst(tuple(each.judge(told) for each in _LOW_BATTERY if each.setting.exists(told)) or (Judgement(_GO, ""),))


_AP_FENCE: Final = {
    name: _parameter(name, None)
    for name in ("FENCE_ENABLE", "FENCE_TYPE", "FENCE_ACTION", "FENCE_ALT_MAX", "FENCE_RADIUS", "FENCE_MARGIN")
}
_PX4_FENCE: Final = {name: _parameter(None, name) for name in ("GF_ACTION", "GF_MAX_VER_DIST", "GF_MAX_HOR_DIST")}
_CEILING, _CIRCLE = 1, 2
_KINDS: Final = ((_CEILING, "a ceiling"), (_CIRCLE, "a circle"), (4, "areas"), (8, "a floor"))
_WARNS: Final = 1


def _fence(asked: Asked, told: Told) -> Judgement:
    """Whether a fence is watched, and whether the plan stays within its height and its distance from home."""
    settings = _AP_FENCE if told.autopilot == ARDUPILOT else _PX4_FENCE
    values = {name: value for name, setting in settings.items() if (value := setting.of(told)) is not None}
    state = values.get("FENCE_ENABLE" if told.autopilot == ARDUPILOT else "GF_ACTION")
    if state is None:
        return Judgement(Level.UNKNOWN, f"{next(iter(settings))} is not known")
    if state.value <= 0.0:
        if asked.fenced:
            left_out = f", without {listed(asked.unfenced)}, which moves" if asked.unfenced else ""
            return Judgement(_GO, f"off ({state}) until the flight sets its own{left_out}")
        return Judgement(_CAUTION, f"off ({state})", "a fence is a second guard, of the vehicle's own")
    if told.autopilot == ARDUPILOT:
        kinds = int(values["FENCE_TYPE"].value) if "FENCE_TYPE" in values else 0
        margin_m = values["FENCE_MARGIN"].value if "FENCE_MARGIN" in values else 0.0
        ceiling = values.get("FENCE_ALT_MAX") if kinds & _CEILING else None
        circle = values.get("FENCE_RADIUS") if kinds & _CIRCLE else None
        figure = "on: " + (", ".join(words for bit, words in _KINDS if kinds & bit) or "no kind of it")
        acts = "FENCE_ACTION" not in values or values["FENCE_ACTION"].value > 0.0
    else:
        margin_m, figure, acts = 0.0, f"on ({state})", state.value > _WARNS
        ceiling, circle = (
            value if (value := values.get(name)) is not None and value.value > 0.0 else None
            for name in ("GF_MAX_VER_DIST", "GF_MAX_HOR_DIST")
        )
    found = [Judgement(_GO, figure) if acts else Judgement(_CAUTION, f"{figure}, and warns only")]
    for limit, needed_m, what in ((ceiling, asked.altitude_m, "high"), (circle, asked.reach_m, "away from home")):
        if limit is not None and limit.value - margin_m < needed_m:
            words = f"the plan is {needed_m:.0f} m {what}, and {limit} less a margin of {margin_m:g} m ends it before"
            found.append(Judgement(_NO_GO, words, f"set {limit.name} to {limit.at_least(needed_m + margin_m)} or more"))
    return worst(tuple(found))


FAILSAFE_ROWS: Final = (
    Row("setpoints", _setpoints, (_SILENCE, _SETPOINT_LOSS.setting)),
    Row("link-loss", _link_loss, (_LINK_LOSS.setting, _WATCHED)),
    Row("sticks-loss", lambda _asked, told: _STICKS_LOSS.judge(told), (_STICKS_LOSS.setting,)),
    Row("low-battery", _low_battery, tuple(each.setting for each in _LOW_BATTERY)),
    Row("fence", _fence, (*_AP_FENCE.values(), *_PX4_FENCE.values())),
)
