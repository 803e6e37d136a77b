"""What the vehicle keeps to by itself, against what the plan asks of it.

ArduPilot's names before and after the renaming of version 4.7 (its wiki, "Parameter Name Changes"), which also changed
centimetres into metres and centidegrees into degrees; PX4's from its parameter reference.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from mission.fly.preflight.rows import ARDUPILOT, PX4, Asked, Judgement, Level, Row, Setting, Told
from mission.monitor.attitude import GRAVITY_M_S2

_CM: Final = 0.01
_DEGREE: Final = math.radians(1.0)
_CENTIDEGREE: Final = math.radians(0.01)
_ROUNDING: Final = 1e-4
"""Relative: parameters are floats of 32 bits."""


@dataclass(frozen=True)
class _Limit:
    """One limit.

    Attributes:
        unit: How figures are shown, with what one of them is of the unit of here.
        needed: What the plan cannot do without; None where it does without.
        key: What says so in the mission file.
        settings: The parameters; the strictest holds.
        wanted: What the plan would use if it could; a vehicle that gives less costs a caution.
        unlimited: What is said of an autopilot that has no such limit.
    """

    unit: tuple[str, float]
    needed: Callable[[Asked], float | None]
    key: str
    settings: tuple[Setting, ...]
    wanted: Callable[[Asked], float | None] = lambda _asked: None
    unlimited: str = ""

    def judge(self, asked: Asked, told: Told) -> Judgement:
        """Go where the vehicle allows for what is needed."""
        values = [value for setting in self.settings if (value := setting.of(told)) is not None]
        needed, wanted = self.needed(asked), self.wanted(asked)
        name, size = self.unit
        shown = "" if needed is None else f"{needed / size:.3g} {name} asked"
        if not any(setting.exists(told) for setting in self.settings):
            return Judgement(Level.GO, f"{shown}; {self.unlimited}".removeprefix("; "))
        if not values:
            missing = self.settings[0].names[told.autopilot][-1][0]
            return Judgement(Level.UNKNOWN, f"{shown}; {missing} is not known".removeprefix("; "))
        least = min(values, key=lambda value: value.value)
        figure = f"{shown}, {least.value / size:.3g} {name} allowed ({least})".removeprefix(", ")
        if needed is not None and least.value < needed * (1.0 - _ROUNDING):
            ways = f"set {least.name} to {least.at_least(needed)} or more, or {self.key} in the file to less"
            return Judgement(Level.NO_GO, figure, ways, blames_file=True)
        if wanted is not None and least.value < wanted * (1.0 - _ROUNDING):
            figure += f"; up to {wanted / size:.3g} {name} may be of use"
            return Judgement(Level.CAUTION, figure, f"set {least.name} to {least.at_least(wanted)} or more")
        return Judgement(Level.GO, figure)


_LIMITS: Final = {
    "speed": _Limit(
        ("m/s", 1.0),
        lambda asked: asked.speed_m_s,
        "flight.speed_m_s",
        (Setting({ARDUPILOT: (("WP_SPD", 1.0), ("WPNAV_SPEED", _CM)), PX4: (("MPC_XY_VEL_MAX", 1.0),)}),),
    ),
    "acceleration": _Limit(
        ("m/s²", 1.0),
        lambda asked: asked.acceleration_m_s2,
        "limits.acceleration_m_s2",
        (Setting({ARDUPILOT: (("WP_ACC", 1.0), ("WPNAV_ACCEL", _CM)), PX4: (("MPC_ACC_HOR_MAX", 1.0),)}),),
    ),
    "jerk": _Limit(
        ("m/s³", 1.0),
        lambda asked: asked.jerk_m_s3,
        "limits.jerk_m_s3",
        (Setting({ARDUPILOT: (("PSC_NE_JERK", 1.0), ("PSC_JERK_XY", 1.0))}),),
        unlimited="PX4 limits none in Offboard",
    ),
    "tilt": _Limit(
        ("°", _DEGREE),
        lambda asked: math.atan(asked.acceleration_m_s2 / GRAVITY_M_S2),
        "limits.acceleration_m_s2",
        (
            Setting(
                {
                    ARDUPILOT: (("ATC_ANGLE_MAX", _DEGREE), ("ANGLE_MAX", _CENTIDEGREE)),
                    PX4: (("MPC_TILTMAX_AIR", _DEGREE),),
                }
            ),
            Setting({ARDUPILOT: (("PSC_ANGLE_MAX", _DEGREE),)}, none_is_none=True),
        ),
        wanted=lambda asked: asked.tilt_rad,
    ),
    "yaw-rate": _Limit(
        ("°/s", _DEGREE),
        lambda asked: asked.yaw_rate_rad_s,
        "limits.yaw_rate_deg_s",
        (
            Setting(
                {
                    ARDUPILOT: (("ATC_RATE_WPY_MAX", _DEGREE), ("ATC_SLEW_YAW", _CENTIDEGREE)),
                    PX4: (("MPC_YAWRAUTO_MAX", _DEGREE),),
                }
            ),
            Setting(
                {ARDUPILOT: (("ATC_RATE_Y_MAX", _DEGREE),), PX4: (("MC_YAWRATE_MAX", _DEGREE),)}, none_is_none=True
            ),
        ),
    ),
}

LIMIT_ROWS: Final = tuple(Row(name, limit.judge, limit.settings) for name, limit in _LIMITS.items())
