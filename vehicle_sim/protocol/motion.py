"""Telemetry of motion: attitude, position, velocity, and the setpoint that is flown.

All of it is the vehicle's estimate, never the truth. Message definitions: https://mavlink.io/en/messages/common.html.
"""

from math import cos, hypot, nan, sin

from vehicle_sim.autopilot import Mode
from vehicle_sim.geodesy import geodetic_at, ned_offset_m
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host
from vehicle_sim.protocol.units import E7, clamp, clamp16, heading_deg, wrapped
from vehicle_sim.signals import Estimate, Setpoint, Vector

_UNKNOWN_HEADING = 65535


def attitude(host: Host) -> Message | None:
    """ATTITUDE: Euler angles and body rates."""
    estimate = host.vehicle.estimate
    rates = estimate.rates_rad_s
    return mavlink.MAVLink_attitude_message(
        host.now_us // 1000,
        estimate.roll_rad,
        estimate.pitch_rad,
        wrapped(estimate.yaw_rad),
        rates[0],
        rates[1],
        rates[2],
    )


def quaternion(estimate: Estimate) -> tuple[float, float, float, float]:
    """Return w, x, y, z of the rotation from body to local, of the Euler angles yaw, pitch, roll in this order."""
    cr, sr = cos(estimate.roll_rad / 2), sin(estimate.roll_rad / 2)
    cp, sp = cos(estimate.pitch_rad / 2), sin(estimate.pitch_rad / 2)
    cy, sy = cos(estimate.yaw_rad / 2), sin(estimate.yaw_rad / 2)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def attitude_quaternion(host: Host) -> Message | None:
    """ATTITUDE_QUATERNION: the same as a quaternion."""
    estimate = host.vehicle.estimate
    return mavlink.MAVLink_attitude_quaternion_message(
        host.now_us // 1000, *quaternion(estimate), *estimate.rates_rad_s
    )


def local_position_ned(host: Host) -> Message | None:
    """LOCAL_POSITION_NED: relative to the estimator's origin, hence nothing before there is one."""
    estimate = host.vehicle.estimate
    if estimate.origin is None:
        return None
    return mavlink.MAVLink_local_position_ned_message(
        host.now_us // 1000, *estimate.position_ned_m, *estimate.velocity_ned_m_s
    )


def global_position_int(host: Host) -> Message | None:
    """GLOBAL_POSITION_INT: place, height above sea and home, velocity in cm/s, heading.

    Before the estimator has an origin, ArduPilot sends zeros for the place and PX4 sends nothing.
    """
    estimate = host.vehicle.estimate
    if estimate.origin is None:
        if host.table.flavour is Flavour.PX4:
            return None
        zeros = (0,) * 7
        return mavlink.MAVLink_global_position_int_message(host.now_us // 1000, *zeros, _UNKNOWN_HEADING)
    place = geodetic_at(estimate.origin, estimate.position_ned_m)
    home = host.vehicle.autopilot.home
    above_home_m = place.alt_m - (home.alt_m if home else estimate.origin.alt_m)
    north, east, down = estimate.velocity_ned_m_s
    return mavlink.MAVLink_global_position_int_message(
        host.now_us // 1000,
        round(place.lat_deg * E7),
        round(place.lon_deg * E7),
        round(place.alt_m * 1000),
        round(above_home_m * 1000),
        clamp16(north * 100),
        clamp16(east * 100),
        clamp16(down * 100),
        round(heading_deg(estimate.yaw_rad) * 100) % 36000,
    )


def vfr_hud(host: Host) -> Message | None:
    """VFR_HUD: what a head-up display shows; speeds in m/s, altitude above mean sea level."""
    estimate = host.vehicle.estimate
    north, east, down = estimate.velocity_ned_m_s
    speed = hypot(north, east)
    altitude_m = estimate.origin.alt_m - estimate.position_ned_m[2] if estimate.origin else 0.0
    return mavlink.MAVLink_vfr_hud_message(
        speed,
        speed,
        round(heading_deg(estimate.yaw_rad)) % 360,
        clamp(host.vehicle.thrust * 100, 0, 100),
        altitude_m,
        -down,
    )


def altitude(host: Host) -> Message | None:
    """ALTITUDE (PX4): the same height from each of its zeros."""
    estimate = host.vehicle.estimate
    if estimate.origin is None:
        return None
    local_m = -estimate.position_ned_m[2]
    amsl_m = estimate.origin.alt_m + local_m
    home = host.vehicle.autopilot.home
    relative_m = amsl_m - home.alt_m if home else local_m
    return mavlink.MAVLink_altitude_message(host.now_us, amsl_m, amsl_m, local_m, relative_m, nan, nan)


def odometry(host: Host) -> Message | None:
    """ODOMETRY (PX4): pose in the local frame, velocity in body axes forward, right, down."""
    estimate = host.vehicle.estimate
    if estimate.origin is None:
        return None
    status = estimate.status
    pose = _covariance_diagonal(status.horizontal_accuracy_m, status.vertical_accuracy_m)
    motion = _covariance_diagonal(status.speed_accuracy_m_s, status.speed_accuracy_m_s)
    return mavlink.MAVLink_odometry_message(
        host.now_us,
        mavlink.MAV_FRAME_LOCAL_NED,
        mavlink.MAV_FRAME_BODY_FRD,
        *estimate.position_ned_m,
        quaternion(estimate),
        *_to_body(estimate),
        *estimate.rates_rad_s,
        pose,
        motion,
        0,
        mavlink.MAV_ESTIMATOR_TYPE_AUTOPILOT,
        100,
    )


def _covariance_diagonal(horizontal: float, vertical: float) -> list[float]:
    """Return the upper triangle of a 6 x 6 matrix, rows first: variances of x, y, z; unknown elsewhere."""
    triangle = [nan] * 21
    triangle[0] = triangle[6] = horizontal**2
    triangle[11] = vertical**2
    return triangle


def _to_body(estimate: Estimate) -> Vector:
    """Turn the velocity from north, east, down to forward, right, down."""
    w, x, y, z = quaternion(estimate)
    n, e, d = estimate.velocity_ned_m_s
    return (
        (1 - 2 * (y * y + z * z)) * n + 2 * (x * y + w * z) * e + 2 * (x * z - w * y) * d,
        2 * (x * y - w * z) * n + (1 - 2 * (x * x + z * z)) * e + 2 * (y * z + w * x) * d,
        2 * (x * z + w * y) * n + 2 * (y * z - w * x) * e + (1 - 2 * (x * x + y * y)) * d,
    )


def position_target_local_ned(host: Host) -> Message | None:
    """POSITION_TARGET_LOCAL_NED: what is flown to.

    ArduPilot: the last guided target, in GUIDED only, with the type mask of what was asked. PX4: the controller's
    setpoint, NaN where it has none.
    """
    autopilot = host.vehicle.autopilot
    target = autopilot.target
    if target is None:
        return None
    if host.table.flavour is Flavour.ARDUPILOT:
        # By attitude there is no place or velocity to tell.
        if autopilot.mode is not Mode.GUIDED or target.lean_ne_rad is not None:
            return None
        mask, absent = type_mask(target), 0.0
    else:
        mask, absent = 0, nan
    fields = [
        absent if value is None else value
        for vector in (target.position_ned_m, target.velocity_ned_m_s, target.acceleration_ned_m_s2)
        for value in vector
    ]
    yaw = absent if target.yaw_rad is None else target.yaw_rad
    rate = absent if target.yaw_rate_rad_s is None else target.yaw_rate_rad_s
    return mavlink.MAVLink_position_target_local_ned_message(
        host.now_us // 1000, mavlink.MAV_FRAME_LOCAL_NED, mask, *fields, yaw, rate
    )


def position_target_global_int(host: Host) -> Message | None:
    """POSITION_TARGET_GLOBAL_INT: the place that is flown to, altitude above mean sea level."""
    target, origin = host.vehicle.autopilot.target, host.vehicle.estimate.origin
    if target is None or origin is None:
        return None
    north, east, down = target.position_ned_m
    if north is None or east is None or down is None:
        return None
    place = geodetic_at(origin, (north, east, down))
    velocity = [value or 0.0 for value in target.velocity_ned_m_s]
    acceleration = [value or 0.0 for value in target.acceleration_ned_m_s2]
    return mavlink.MAVLink_position_target_global_int_message(
        host.now_us // 1000,
        mavlink.MAV_FRAME_GLOBAL,
        type_mask(target),
        round(place.lat_deg * E7),
        round(place.lon_deg * E7),
        place.alt_m,
        *velocity,
        *acceleration,
        target.yaw_rad or 0.0,
        target.yaw_rate_rad_s or 0.0,
    )


def type_mask(target: Setpoint) -> int:
    """Return POSITION_TARGET_TYPEMASK: a bit for each component that is not asked for."""
    mask, bit = 0, 1
    for vector in (target.position_ned_m, target.velocity_ned_m_s, target.acceleration_ned_m_s2):
        for value in vector:
            mask |= bit if value is None else 0
            bit <<= 1
    mask |= mavlink.POSITION_TARGET_TYPEMASK_YAW_IGNORE if target.yaw_rad is None else 0
    return mask | (mavlink.POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE if target.yaw_rate_rad_s is None else 0)


def home_position(host: Host) -> Message | None:
    """HOME_POSITION: where it returns to, also relative to the estimator's origin."""
    home, origin = host.vehicle.autopilot.home, host.vehicle.estimate.origin
    if home is None or origin is None:
        return None
    north, east, down = ned_offset_m(origin, home)
    return mavlink.MAVLink_home_position_message(
        round(home.lat_deg * E7),
        round(home.lon_deg * E7),
        round(home.alt_m * 1000),
        north,
        east,
        down,
        (1.0, 0.0, 0.0, 0.0),
        0.0,
        0.0,
        0.0,
        host.now_us,
    )


def gps_global_origin(host: Host) -> Message | None:
    """GPS_GLOBAL_ORIGIN: where the estimator's local frame has its origin; nothing before it has one."""
    origin = host.vehicle.estimate.origin
    if origin is None:
        return None
    return mavlink.MAVLink_gps_global_origin_message(
        round(origin.lat_deg * E7), round(origin.lon_deg * E7), round(origin.alt_m * 1000), host.now_us
    )
