"""What the vehicle tells of the day: where it stands, its charge, wind, satellites, estimator, mode and firmware."""

import math
from typing import Final

from mission.fly.preflight.rows import ARDUPILOT, PX4, Asked, Judgement, Level, Row, Setting, Told
from mission.monitor.attitude import GRAVITY_M_S2
from mission.spec.battery import Battery
from mission.spec.finding import listed

_PERCENT: Final = 100.0
_LITTLE_PERCENT: Final = 30.0
CAPACITY: Final = Setting({ARDUPILOT: (("BATT_CAPACITY", 1.0),), PX4: (("BAT1_CAPACITY", 1.0),)}, none_is_none=True)


def _battery(asked: Asked, told: Told) -> Judgement:
    """The charge that the plan takes against what is left, above the reserve."""
    percent, capacity = told.battery_percent, CAPACITY.of(told)
    if told.battery_critical:
        return Judgement(Level.NO_GO, "the vehicle calls its charge critical", "charge it, or change it")
    if percent is None:
        return Judgement(Level.UNKNOWN, "the vehicle does not tell its charge", "set up its battery monitor")
    left = f"{percent:.0f} % left"
    capacity_mah = None if capacity is None else capacity.value
    if asked.battery is not None:
        return _charge(asked, asked.battery, percent, asked.battery.capacity_mah or capacity_mah)
    if percent < _LITTLE_PERCENT:
        return Judgement(Level.CAUTION, f"{left}; the file does not say what a flight takes", "charge it")
    return Judgement(Level.GO, f"{left}{_allows(asked, percent, capacity_mah)}")


def _charge(asked: Asked, battery: Battery, percent: float, capacity_mah: float | None) -> Judgement:
    """The same where the file says what a flight takes."""
    left = f"{percent:.0f} % left"
    if capacity_mah is None:
        return Judgement(Level.UNKNOWN, f"{left} of a capacity that is not known", "battery.capacity_mah says it")
    if math.isinf(asked.air_s):
        return Judgement(Level.CAUTION, f"{left}, and laps without an end", "come back in time, or give `laps`")
    needed_mah = battery.charge_mah(asked.air_s)
    spare_mah = (percent / _PERCENT - battery.reserve) * capacity_mah
    figure = (
        f"{needed_mah:.0f} mAh needed for {asked.air_s:.0f} s at {battery.current_a:g} A, {left} of {capacity_mah:.0f} "
        f"mAh: {max(spare_mah, 0.0):.0f} above the reserve of {battery.reserve * _PERCENT:g} %"
    )
    if needed_mah > spare_mah:
        return Judgement(Level.NO_GO, figure, "charge it, or fly less")
    return Judgement(Level.GO, figure)


def _allows(asked: Asked, percent: float, capacity_mah: float | None) -> str:
    """What a vehicle may draw on average if nothing is said of that."""
    if capacity_mah is None or math.isinf(asked.air_s):
        return ""
    most_a = percent / _PERCENT * capacity_mah * 3.6 / asked.air_s
    suffices = f"suffices for {asked.air_s:.0f} s at up to {most_a:.0f} A; see `battery` in the file"
    return f" of {capacity_mah:.0f} mAh: {suffices}"


_MOMENTUM: Final = Setting({ARDUPILOT: (("EK3_DRAG_MCOEF", 1.0),), PX4: (("EKF2_MCOEF", 1.0),)}, none_is_none=True)
_BALLISTIC: Final = Setting({ARDUPILOT: (("EK3_DRAG_BCOEF_X", 1.0),), PX4: (("EKF2_BCOEF_X", 1.0),)}, none_is_none=True)
_USUAL_MOMENTUM_PER_S: Final = 0.15
"""PX4's default of EKF2_MCOEF."""

_AIR_KG_M3: Final = 1.225


def _wind(asked: Asked, told: Told) -> Judgement:
    """What the wind pushes, by the estimator's own model of drag, against what is proved and what can be leant against.

    The model of both estimators has two parts: momentum drag, linear in the airspeed, and that of a bluff body,
    rho v^2 / (2 BCOEF).
    """
    proved = f"the proof allows for {asked.disturbance_m_s2:.2g} m/s²"
    if told.wind is None or told.wind.speed_m_s == 0.0:  # ArduPilot's word for not knowing
        return Judgement(Level.UNKNOWN, f"the vehicle has no estimate of it; {proved}")
    momentum, ballistic, speed_m_s = _MOMENTUM.of(told), _BALLISTIC.of(told), told.wind.speed_m_s
    push_m_s2 = speed_m_s * (_USUAL_MOMENTUM_PER_S if momentum is None else momentum.value)
    push_m_s2 += 0.0 if ballistic is None else 0.5 * _AIR_KG_M3 * speed_m_s**2 / ballistic.value
    lean_m_s2 = GRAVITY_M_S2 * math.tan(asked.tilt_rad)
    figure = f"{speed_m_s:.1f} m/s from {told.wind.from_deg:.0f}°, a push of about {push_m_s2:.2g} m/s²; {proved}"
    if push_m_s2 + asked.acceleration_m_s2 > lean_m_s2:
        figure += f", and with {asked.acceleration_m_s2:.2g} m/s² of the plan it is more than {lean_m_s2:.2g} m/s²"
        return Judgement(Level.NO_GO, f"{figure}, a lean of {math.degrees(asked.tilt_rad):.0f}°", "wait for less wind")
    if push_m_s2 > asked.disturbance_m_s2:
        return Judgement(
            Level.CAUTION, figure, "measure the tube in this wind (`mission calibrate`), or give `disturbance_m_s2`"
        )
    return Judgement(Level.GO, figure)


_FIX_3D: Final = 3
_LEAST, _FEW = 6, 9
_GOOD_DILUTION: Final = 2.0


def _satellites(_asked: Asked, told: Told) -> Judgement:
    """Whether the receiver has a place, and how good that can be."""
    fix = told.fix
    if fix is None:
        return Judgement(Level.UNKNOWN, "the vehicle does not tell of its receiver")
    words = [] if fix.satellites is None else [f"{fix.satellites} satellites"]
    words += [] if fix.dilution is None else [f"HDOP {fix.dilution:.1f}"]
    words += [] if fix.accuracy_m is None else [f"within {fix.accuracy_m[0]:.1f} m"]
    figure = ", ".join(words)
    if fix.kind < _FIX_3D:
        return Judgement(Level.NO_GO, ", ".join(("no place", *words)), "wait under an open sky")
    if fix.satellites is not None and fix.satellites < _LEAST:
        return Judgement(Level.NO_GO, figure, f"wait for {_LEAST} satellites and more under an open sky")
    few = fix.satellites is not None and fix.satellites < _FEW
    if few or (fix.dilution or 0.0) > _GOOD_DILUTION:
        return Judgement(Level.CAUTION, figure, f"wait for {_FEW} satellites and HDOP {_GOOD_DILUTION:g}")
    return Judgement(Level.GO, figure or "a place with a height")


_REFUSES, _DOUBTS = 1.0, 0.8


def _estimator(_asked: Asked, told: Told) -> Judgement:
    """Whether the estimator has what a flight needs, and whether measurements agree with it."""
    ratio = "" if told.worst_ratio is None else f"largest test ratio {told.worst_ratio:.2f}"
    if told.unready:
        return Judgement(Level.NO_GO, told.unready, "wait until it is ready")
    if told.worst_ratio is None:
        return Judgement(Level.UNKNOWN, "the vehicle does not tell of it")
    if told.worst_ratio >= _REFUSES:
        return Judgement(Level.NO_GO, f"{ratio}: it refuses what is measured", "see its compass and its receiver")
    if told.worst_ratio >= _DOUBTS:
        return Judgement(Level.CAUTION, ratio, "see its compass and its receiver")
    return Judgement(Level.GO, ratio)


def _vehicle(asked: Asked, told: Told) -> Judgement:
    """Whether it is known which vehicle is meant."""
    others = listed(sorted(told.systems - {told.system_id}))
    if not others:
        return Judgement(Level.GO, f"system id {told.system_id}, the only one on this link")
    if asked.chosen:
        return Judgement(Level.GO, f"system id {told.system_id}, as asked for; also heard: {others}")
    figure = f"system id {told.system_id} was heard first; also heard: {others}"
    return Judgement(Level.NO_GO, figure, f"say which one is meant, such as `--system-id {told.system_id}`")


def _mode(_asked: Asked, told: Told) -> Judgement:
    """Whether the vehicle can be told to begin."""
    if told.busy:
        return Judgement(Level.NO_GO, f"{told.busy}, in {told.mode}", "land and disarm it, and see what it says")
    return Judgement(Level.GO, f"{told.mode}, disarmed on the ground")


_FIRMWARE: Final = {ARDUPILOT: ((4, 1), (4, 7)), PX4: ((1, 11), (1, 16))}
"""By autopilot: the version that has all that is needed, and the one with which this program was tried.

ArduCopter takes accelerations beside positions and velocities from 4.1 on, PX4 requests for messages from 1.11 on.
"""


def _firmware(_asked: Asked, told: Told) -> Judgement:
    """Whether the firmware has all that is needed."""
    if told.firmware is None or told.firmware == (0, 0, 0):
        return Judgement(Level.UNKNOWN, f"{told.autopilot} does not tell its version")
    needed, tried = _FIRMWARE[told.autopilot]
    figure = f"{told.autopilot} {'.'.join(map(str, told.firmware))}"
    names = [".".join(map(str, version)) for version in (needed, tried)]
    if told.firmware[:2] < needed:
        return Judgement(Level.NO_GO, f"{figure}; {names[0]} and later have all that is needed", "update it")
    if told.firmware[:2] < tried:
        return Judgement(
            Level.CAUTION, f"{figure}; tried were {names[1]} and later", "try it in a simulator, or update it"
        )
    return Judgement(Level.GO, figure)


_NO_PLAN: Final = "nothing can be planned from elsewhere: carry the vehicle to the start, or see the file's `origin`"

SURROUNDING_ROWS: Final = (
    Row("vehicle", _vehicle),
    Row("firmware", _firmware),
    Row("mode", _mode),
    Row("estimator", _estimator),
    Row("satellites", _satellites),
    Row("origin", lambda _asked, told: told.stand, firm=_NO_PLAN),
    Row("battery", _battery, (CAPACITY,)),
    Row("wind", _wind, (_MOMENTUM, _BALLISTIC)),
)
