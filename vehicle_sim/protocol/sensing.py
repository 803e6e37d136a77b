"""Telemetry of what is measured and put out: receiver, inertial unit, barometer, clock, outputs.

Message definitions: https://mavlink.io/en/messages/common.html.
"""

from math import atan2, hypot
from typing import TYPE_CHECKING, Final

from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host
from vehicle_sim.protocol.units import E7, clamp, clamp16, heading_deg
from vehicle_sim.signals import GRAVITY_M_S2, Vector

if TYPE_CHECKING:
    from vehicle_sim.vehicle import Readings

_UNKNOWN: Final = 65535
UTC_OF_FIRST_BOOT_US: Final = 1_735_689_600_000_000
"""The vehicle is switched on at 2025-01-01 00:00 UTC: every flight is reproducible to the byte."""

_NO_FIELD: Final[Vector] = (0.0, 0.0, 0.0)
_HIGHRES_FIELDS: Final = 0b1_1011_1111_1111
"""All of HIGHRES_IMU but the differential pressure, which a multicopter has no tube for."""


def gps_raw_int(host: Host) -> Message | None:
    """GPS_RAW_INT: the receiver's own fix, also while there is none."""
    gps = host.vehicle.readings.gps
    if gps is None:
        no_fix = mavlink.GPS_FIX_TYPE_NO_FIX
        return mavlink.MAVLink_gps_raw_int_message(host.now_us, no_fix, 0, 0, 0, *(_UNKNOWN,) * 4, 0)
    place = gps.position
    north, east, _down = gps.velocity_ned_m_s
    return mavlink.MAVLink_gps_raw_int_message(
        round(gps.time_s * 1e6),
        gps.fix_type,
        round(place.lat_deg * E7),
        round(place.lon_deg * E7),
        round(place.alt_m * 1000),
        clamp(gps.hdop * 100, 0, _UNKNOWN - 1),
        clamp(gps.vdop * 100, 0, _UNKNOWN - 1),
        clamp(hypot(north, east) * 100, 0, _UNKNOWN - 1),
        round(heading_deg(atan2(east, north)) * 100) % 36000,
        gps.satellites,
        round(place.alt_m * 1000),
        round(gps.horizontal_accuracy_m * 1000),
        round(gps.vertical_accuracy_m * 1000),
        round(gps.speed_accuracy_m_s * 1000),
        0,
        0,
    )


def system_time(host: Host) -> Message | None:
    """SYSTEM_TIME: the date once a receiver told it, and the time since boot."""
    knows_date = host.vehicle.readings.gps is not None
    unix_us = host.utc_of_boot_us + host.now_us if knows_date else 0
    return mavlink.MAVLink_system_time_message(unix_us, host.now_us // 1000)


def _thousandths(vector: Vector, unit: float = 1.0) -> tuple[int, int, int]:
    x, y, z = vector
    scale = 1000.0 / unit
    return clamp16(x * scale), clamp16(y * scale), clamp16(z * scale)


def _inertial(readings: "Readings") -> tuple[int, ...]:
    """Return specific force in mG, rates in mrad/s and the earth's field in mGauss."""
    field = readings.compass.field_gauss if readings.compass is not None else _NO_FIELD
    return (
        *_thousandths(readings.imu.specific_force_m_s2, GRAVITY_M_S2),
        *_thousandths(readings.imu.rates_rad_s),
        *_thousandths(field),
    )


def raw_imu(host: Host) -> Message | None:
    """RAW_IMU (ArduPilot): the inertial unit and the compass."""
    return mavlink.MAVLink_raw_imu_message(host.now_us, *_inertial(host.vehicle.readings))


def scaled_imu(host: Host) -> Message | None:
    """SCALED_IMU: the same, with the time since boot in ms."""
    return mavlink.MAVLink_scaled_imu_message(host.now_us // 1000, *_inertial(host.vehicle.readings))


def highres_imu(host: Host) -> Message | None:
    """HIGHRES_IMU: all that is measured, in SI units, gauss and hPa; nothing before each sensor has."""
    imu, _gps, baro, compass = host.vehicle.readings
    if baro is None or compass is None:
        return None
    return mavlink.MAVLink_highres_imu_message(
        host.now_us,
        *imu.specific_force_m_s2,
        *imu.rates_rad_s,
        *compass.field_gauss,
        baro.pressure_hpa,
        0.0,
        baro.altitude_m,
        baro.temperature_c,
        _HIGHRES_FIELDS,
    )


def scaled_pressure(host: Host) -> Message | None:
    """SCALED_PRESSURE: the barometer; nothing before its first reading."""
    baro = host.vehicle.readings.baro
    if baro is None:
        return None
    return mavlink.MAVLink_scaled_pressure_message(
        host.now_us // 1000, baro.pressure_hpa, 0.0, clamp16(baro.temperature_c * 100)
    )


def vibration(host: Host) -> Message | None:
    """VIBRATION: levels of the body axes in m/s^2, as the rotors shake them; the accelerometers never clip."""
    return mavlink.MAVLink_vibration_message(host.now_us, *host.vehicle.vibration_m_s2, 0, 0, 0)


def rc_channels(host: Host) -> Message | None:
    """RC_CHANNELS: what the radio receives, or MAVLink puts in its place; ArduPilot says 0 of a channel without it."""
    channels = host.vehicle.autopilot.pilot.channels(host.now_us * 1e-6)
    shown = [_UNKNOWN if host.table.flavour is Flavour.PX4 else 0] * 18
    for number, pulse_us in channels.items():
        shown[number - 1] = round(pulse_us)
    return mavlink.MAVLink_rc_channels_message(host.now_us // 1000, max(channels, default=0), *shown, 255)


def rc_channels_raw(host: Host) -> Message | None:
    """RC_CHANNELS_RAW: the first eight channels, for clients that know no other message."""
    shown = host.vehicle.autopilot.pilot.channels(host.now_us * 1e-6)
    pulses = (round(shown.get(number, 0)) for number in range(1, 9))
    return mavlink.MAVLink_rc_channels_raw_message(host.now_us // 1000, 0, *pulses, 255)


def servo_output_raw(host: Host) -> Message | None:
    """SERVO_OUTPUT_RAW: pulse widths in microseconds, linear in the thrust that each rotor really gives.

    Outputs 1 to 4 are the rotors in front, on the right, at the rear and on the left.
    """
    pulses = [clamp(1000 + 1000 * share, 1000, 2000) for share in host.vehicle.airframe.outputs]
    return mavlink.MAVLink_servo_output_raw_message(host.now_us & 0xFFFFFFFF, 0, *pulses, *(0,) * 4)
