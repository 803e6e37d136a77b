"""Telemetry of what is steered to: attitude target, way to the target, corrections, wind; and the simulated truth.

Message definitions: https://mavlink.io/en/messages/common.html and ardupilotmega.html.
"""

from math import atan2, degrees, hypot, nan
from typing import Final

from vehicle_sim.autopilot import Mode
from vehicle_sim.geodesy import geodetic_at
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host
from vehicle_sim.protocol.motion import quaternion
from vehicle_sim.protocol.units import E7, clamp, heading_deg, wrapped

_TO_A_PLACE: Final = frozenset((Mode.GUIDED, Mode.AUTO, Mode.RETURN))
_NO_RATES: Final = (
    mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
    | mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
    | mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE
)
_FARTHEST_M: Final = 65535


def attitude_target(host: Host) -> Message | None:
    """ATTITUDE_TARGET: the attitude and the thrust that the controller asks for; level without thrust while idle."""
    vehicle = host.vehicle
    roll, pitch, yaw = vehicle.attitude_target_rad
    wanted = vehicle.estimate._replace(roll_rad=roll, pitch_rad=pitch, yaw_rad=yaw)
    return mavlink.MAVLink_attitude_target_message(
        host.now_us // 1000, _NO_RATES, quaternion(wanted), 0.0, 0.0, 0.0, min(vehicle.thrust_target, 1.0)
    )


def nav_controller_output(host: Host) -> Message | None:
    """NAV_CONTROLLER_OUTPUT (ArduPilot): the lean asked for, and the way to the place that is flown to.

    Bearing and distance are 0 in modes that fly to no place.
    """
    vehicle = host.vehicle
    autopilot, estimate, target = vehicle.autopilot, vehicle.estimate, vehicle.autopilot.target
    roll, pitch, yaw = vehicle.attitude_target_rad
    bearing, distance, climb = 0, 0, 0.0
    if target is not None:
        north, east, down = target.position_ned_m
        if north is not None and east is not None and autopilot.mode in _TO_A_PLACE:
            to_north, to_east = north - estimate.position_ned_m[0], east - estimate.position_ned_m[1]
            bearing = round(heading_deg(atan2(to_east, to_north)))
            distance = clamp(hypot(to_north, to_east), 0, _FARTHEST_M)
        climb = 0.0 if down is None else estimate.position_ned_m[2] - down
    nav_bearing = bearing if distance else round(heading_deg(yaw))
    return mavlink.MAVLink_nav_controller_output_message(
        degrees(roll), degrees(pitch), _signed(nav_bearing), _signed(bearing), distance, climb, 0.0, 0.0
    )


def _signed(bearing_deg: int) -> int:
    """Return the bearing as ArduPilot sends it: -180 to 180."""
    return (bearing_deg + 180) % 360 - 180


def ahrs(host: Host) -> Message | None:
    """AHRS (ArduPilot): the gyros' drift that is taken out, and the last corrections of tilt and yaw."""
    drift, tilt_miss, yaw_miss = host.vehicle.attitude_corrections
    return mavlink.MAVLink_ahrs_message(*drift, 0.0, 0.0, tilt_miss, abs(yaw_miss))


def wind(host: Host) -> Message | None:
    """WIND (ArduPilot): where the wind comes from, as drag tells; 0 while nothing is known, as ArduPilot has it."""
    north, east = host.vehicle.wind_estimate_ne_m_s or (0.0, 0.0)
    return mavlink.MAVLink_wind_message(degrees(atan2(-east, -north)), hypot(north, east), 0.0)


def wind_cov(host: Host) -> Message | None:
    """WIND_COV (PX4): where the wind blows to, north and east, as drag tells; nothing while nothing is flown."""
    wind_ne = host.vehicle.wind_estimate_ne_m_s
    if wind_ne is None:
        return None
    estimate = host.vehicle.estimate
    altitude_m = -estimate.position_ned_m[2] + (0.0 if estimate.origin is None else estimate.origin.alt_m)
    return mavlink.MAVLink_wind_cov_message(host.now_us, *wind_ne, 0.0, nan, nan, altitude_m, nan, nan)


def orbit_execution_status(host: Host) -> Message | None:
    """ORBIT_EXECUTION_STATUS (PX4): the circle that is flown; its radius is below 0 where it is flown to the left."""
    circle, origin = host.vehicle.autopilot.circle, host.vehicle.estimate.origin
    if circle is None or origin is None:
        return None
    centre = geodetic_at(origin, circle.centre)
    return mavlink.MAVLink_orbit_execution_status_message(
        host.now_us,
        circle.sign * circle.radius_m,
        mavlink.MAV_FRAME_GLOBAL,
        round(centre.lat_deg * E7),
        round(centre.lon_deg * E7),
        centre.alt_m,
    )


def simstate(host: Host) -> Message | None:
    """SIMSTATE (ArduPilot's simulator): the true attitude, specific force, rates and place, no estimate."""
    motion, place = host.vehicle.truth, host.vehicle.true_place
    return mavlink.MAVLink_simstate_message(
        motion.roll_rad,
        motion.pitch_rad,
        wrapped(motion.yaw_rad),
        *motion.specific_force_m_s2,
        *motion.rates_rad_s,
        round(place.lat_deg * E7),
        round(place.lon_deg * E7),
    )
