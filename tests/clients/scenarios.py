"""What is asked of the vehicle: one scenario per program run, the same calls for both versions of MAVSDK."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any, Final

from tests.clients.drone import Drone, refused, seen, tell, told

NAN: Final = float("nan")
HEIGHT_M: Final = 8.0
LAT_DEG, LON_DEG = 47.39775, 8.54560
"""A place near the vehicle's default one."""

STREAMS: Final = (
    "position",
    "home",
    "in_air",
    "landed_state",
    "armed",
    "attitude_quaternion",
    "attitude_euler",
    "attitude_angular_velocity_body",
    "velocity_ned",
    "position_velocity_ned",
    "gps_info",
    "raw_gps",
    "battery",
    "flight_mode",
    "heading",
    "unix_epoch_time",
    "imu",
)
"""Telemetry that every autopilot has."""

WHOLE, REAL = ("LAND_SPEED", "COM_DL_LOSS_T"), ("WPNAV_SPEED", "MPC_XY_CRUISE")
"""A parameter of each kind, of each flavour."""

RATES: Final = (
    "position",
    "home",
    "landed_state",
    "attitude_quaternion",
    "attitude_euler",
    "velocity_ned",
    "position_velocity_ned",
    "gps_info",
    "battery",
    "unix_epoch_time",
    "imu",
    "health",
)


async def ready(drone: Drone) -> None:
    """Ask for telemetry, of which ArduPilot sends none unasked, and wait for health as pilots do."""
    for name in RATES:
        await told(f"rate of {name}", getattr(drone.telemetry, f"set_rate_{name}")(10.0))
    tell("all well", await seen(drone.stream("health_all_ok"), bool))
    tell("health", await seen(drone.stream("health"), lambda health: bool(health.is_armable)))


async def look(drone: Drone) -> None:
    """Identity, health, all telemetry, rates."""
    await told("version", drone.info.get_version())
    await told("product", drone.info.get_product())
    await told("identification", drone.info.get_identification())
    await told("flight", seen(drone.flights()))
    await ready(drone)
    await asyncio.gather(*(told(name, seen(drone.stream(name))) for name in STREAMS))
    await told("origin", drone.telemetry.get_gps_global_origin())
    if drone.reports is not None:
        await told("report", seen(drone.reports(), lambda report: bool(report.current_mode_intention.can_arm_or_run)))
    await asyncio.gather(*(told(name, seen(drone.stream(name), within_s=1.0)) for name in ("odometry", "altitude")))


async def configure(drone: Drone) -> None:
    """Parameters; geofence, missions and rally points up and down; logs and files; arming without a flight."""
    await ready(drone)
    parameters = await drone.param.get_all_params()
    tell("all parameters", parameters)
    (whole,) = (one for one in parameters.int_params if one.name in WHOLE)
    (real,) = (one for one in parameters.float_params if one.name in REAL)
    await told("set whole", drone.param.set_param_int(whole.name, whole.value + 1))
    await told("whole", drone.param.get_param_int(whole.name))
    await told("set real", drone.param.set_param_float(real.name, real.value + 0.5))
    await told("real", drone.param.get_param_float(real.name))
    await carry_plans(drone)
    tell("logs", await refused(drone.log_files.get_entries()))
    await told("files", drone.ftp.list_directory("/"))
    await told("arm to kill", drone.action.arm())
    await told("armed to kill", seen(drone.stream("armed"), bool))
    await told("kill", drone.action.kill())
    await told("killed", seen(drone.stream("armed"), lambda armed: not armed))
    await told("arm to terminate", drone.action.arm())
    await told("armed to terminate", seen(drone.stream("armed"), bool))
    await told("terminate", drone.action.terminate())
    await told("terminated", seen(drone.stream("armed"), lambda armed: not armed))
    tell("arm after termination", await refused(drone.action.arm()))


async def carry_plans(drone: Drone) -> None:
    """Geofence, missions and rally points up and down."""
    await told("fence up", drone.geofence.upload_geofence(fence(drone)))
    await told("fence down", drone.geofence.download_geofence())
    await told("fence cleared", drone.geofence.clear_geofence())
    await told("no fence", drone.geofence.download_geofence())
    await told("mission up", drone.mission.upload_mission(mission(drone)))
    await told("mission items", drone.mission_raw.download_mission())
    await told("mission finished", drone.mission.is_mission_finished())
    await told("mission current", drone.mission.set_current_mission_item(1))
    await told("mission down", drone.mission.download_mission())
    await told("mission cleared", drone.mission.clear_mission())
    await told("raw up", drone.mission_raw.upload_mission(raw_mission(drone)))
    await told("raw down", drone.mission_raw.download_mission())
    await told("raw cleared", drone.mission_raw.clear_mission())
    await told("raw empty", drone.mission_raw.download_mission())
    await told("rally up", drone.mission_raw.upload_rally_points(rally_points(drone)))
    await told("rally down", drone.mission_raw.download_rallypoints())


def e7(degrees: float) -> int:
    """Return degrees as a mission item holds them."""
    return round(degrees * 1e7)


def fence(drone: Drone) -> Any:  # noqa: ANN401 - MAVSDK's own type
    """Return a polygon to stay in, and a circle to stay out of."""
    types = drone.types("geofence")
    corners = [(0.0, 0.0), (0.02, 0.0), (0.02, 0.02), (0.0, 0.02)]
    polygon = types.Polygon(
        [types.Point(LAT_DEG - 0.01 + north, LON_DEG - 0.01 + east) for north, east in corners],
        types.FenceType.INCLUSION,
    )
    circle = types.Circle(types.Point(LAT_DEG + 0.005, LON_DEG), 20.0, types.FenceType.EXCLUSION)
    return types.GeofenceData([polygon], [circle])


def mission(drone: Drone) -> Any:  # noqa: ANN401 - MAVSDK's own type
    """Return three points with a speed each; the second is a stop of a second."""
    types = drone.types("mission")
    return types.MissionPlan(
        [
            types.MissionItem(
                LAT_DEG + north,
                LON_DEG + east,
                HEIGHT_M,
                speed_m_s,
                wait_s == 0.0,
                NAN,
                NAN,
                types.MissionItem.CameraAction.NONE,
                wait_s or NAN,
                NAN,
                1.0,
                NAN,
                NAN,
                types.MissionItem.VehicleAction.NONE,
            )
            for north, east, speed_m_s, wait_s in ((1e-4, 0.0, 5.0, 0.0), (1e-4, 1e-4, 4.0, 1.0), (0.0, 1e-4, 5.0, 0.0))
        ]
    )


def raw_mission(drone: Drone) -> list[Any]:
    """Return three points as items; of the first ArduPilot makes its home."""
    item = drone.types("mission_raw").MissionItem
    places = ((0.0, 0.0), (1e-4, 0.0), (1e-4, 1e-4))
    return [
        item(seq, 3, 16, int(seq == 0), 1, 0, 1, 0, NAN, e7(LAT_DEG + north), e7(LON_DEG + east), HEIGHT_M, 0)
        for seq, (north, east) in enumerate(places)
    ]


def rally_points(drone: Drone) -> list[Any]:
    """Return one rally point."""
    item = drone.types("mission_raw").MissionItem
    return [item(0, 3, 5100, 0, 1, 0, 0, 0, 0, e7(LAT_DEG), e7(LON_DEG), HEIGHT_M, 2)]


async def flown(drone: Drone, topic: str, mode: str) -> None:
    """Tell that the vehicle says that it is in a mode."""
    await told(topic, seen(drone.stream("flight_mode"), lambda seen_mode: seen_mode.name == mode))


async def take_off(drone: Drone) -> None:
    """Arm and climb."""
    await told("set take-off altitude", drone.action.set_takeoff_altitude(HEIGHT_M))
    await told("take-off altitude", drone.action.get_takeoff_altitude())
    await told("arm", drone.action.arm())
    await told("armed", seen(drone.stream("armed"), bool))
    await told("take off", drone.action.takeoff())
    await told("in air", seen(drone.stream("in_air"), bool))
    await told("up", seen(drone.stream("position"), lambda place: place.relative_altitude_m > HEIGHT_M - 0.5))
    await told("flies", seen(drone.stream("landed_state"), lambda state: state.name == "IN_AIR"))


async def fly(drone: Drone) -> None:
    """Action and offboard: a flight from arming to disarming."""
    await ready(drone)
    tell("offboard without a setpoint", await refused(drone.offboard.start()))
    home = await seen(drone.stream("home"))
    await take_off(drone)
    await told("set speed", drone.action.set_current_speed(4.0))
    north_deg = home.latitude_deg + 1e-4
    await told(
        "go", drone.action.goto_location(north_deg, home.longitude_deg, home.absolute_altitude_m + HEIGHT_M, 90.0)
    )
    await told("there", seen(drone.stream("position"), lambda place: place.latitude_deg > north_deg - 1e-5))
    await told("looks east", seen(drone.stream("heading"), lambda heading: abs(heading.heading_deg - 90.0) < 5.0))
    tell("disarm in the air", await refused(drone.action.disarm()))
    await told("hold", drone.action.hold())
    await flown(drone, "holds", "HOLD")
    await steer(drone)
    await told("return", drone.action.return_to_launch())
    await flown(drone, "returns", "RETURN_TO_LAUNCH")
    await told("land", drone.action.land())
    await flown(drone, "lands", "LAND")
    await told("landing", seen(drone.stream("landed_state"), lambda state: state.name == "LANDING"))
    await told("on ground", seen(drone.stream("landed_state"), lambda state: state.name == "ON_GROUND"))
    await told("disarmed", seen(drone.stream("armed"), lambda armed: not armed))
    await told("stands", seen(drone.stream("in_air"), lambda in_air: not in_air))


async def steer(drone: Drone) -> None:
    """Offboard: positions, velocities, and both together."""
    offboard, types = drone.offboard, drone.types("offboard")

    async def reached(topic: str, north_m: float, east_m: float) -> None:
        def near(motion: Any) -> bool:  # noqa: ANN401 - MAVSDK's own type
            place = motion.position
            return bool(abs(place.north_m - north_m) < 1.0 and abs(place.east_m - east_m) < 1.0)

        await told(topic, seen(drone.stream("position_velocity_ned"), near))

    async def moves(topic: str, north_m_s: float, east_m_s: float) -> None:
        def so(motion: Any) -> bool:  # noqa: ANN401 - MAVSDK's own type
            speed = motion.velocity
            return bool(abs(speed.north_m_s - north_m_s) < 0.4 and abs(speed.east_m_s - east_m_s) < 0.4)

        await told(topic, seen(drone.stream("position_velocity_ned"), so))

    still = types.VelocityNedYaw(0.0, 0.0, 0.0, 0.0)
    await told("point", offboard.set_position_ned(types.PositionNedYaw(5.0, 5.0, -HEIGHT_M, 0.0)))
    await told("offboard", offboard.start())
    await told("offboard is active", offboard.is_active())
    await flown(drone, "flies offboard", "OFFBOARD")
    await reached("at the point", 5.0, 5.0)
    await told("velocity", offboard.set_velocity_ned(types.VelocityNedYaw(0.0, 2.0, 0.0, 0.0)))
    await moves("moves east", 0.0, 2.0)
    await told("body velocity", offboard.set_velocity_body(types.VelocityBodyYawspeed(1.5, 0.0, 0.0, 0.0)))
    await moves("moves ahead", 1.5, 0.0)
    await told("both", offboard.set_position_velocity_ned(types.PositionNedYaw(0.0, 0.0, -HEIGHT_M, 0.0), still))
    await reached("at both", 0.0, 0.0)
    await told(
        "all three",
        offboard.set_position_velocity_acceleration_ned(
            types.PositionNedYaw(4.0, 0.0, -HEIGHT_M, 0.0), still, types.AccelerationNed(0.0, 0.0, 0.0)
        ),
    )
    await reached("at all three", 4.0, 0.0)
    await told("stop", offboard.stop())
    await flown(drone, "flies no longer offboard", "HOLD")


async def fly_mission(drone: Drone) -> None:
    """A mission of the plugin `mission`: uploaded, started, paused, gone on with, flown to its end, cleared."""
    await ready(drone)
    await take_off(drone)
    await told("mission up", drone.mission.upload_mission(mission(drone)))
    await through(drone, "mission")
    await told("finished", drone.mission.is_mission_finished())
    await come_down(drone, "mission")


async def fly_raw_mission(drone: Drone) -> None:
    """A mission of the plugin `mission_raw`, as ArduPilot needs it: item 0 stands for home."""
    await ready(drone)
    await take_off(drone)
    await told("mission up", drone.mission_raw.upload_mission(raw_mission(drone)))
    await through(drone, "mission_raw")
    await come_down(drone, "mission_raw")


async def through(drone: Drone, name: str) -> None:
    """Fly a mission that was uploaded, with a pause."""
    plugin = getattr(drone, name)
    await told("start", plugin.start_mission())
    await flown(drone, "flies the mission", "MISSION")
    await told("first reached", seen(drone.progress(name), lambda progress: progress.current >= 1))
    await told("pause", plugin.pause_mission())
    await flown(drone, "paused", "HOLD")
    await told("go on", plugin.start_mission())
    await flown(drone, "flies again", "MISSION")
    await told("all reached", seen(drone.progress(name), lambda progress: progress.current == progress.total > 0))


async def come_down(drone: Drone, name: str) -> None:
    """Forget the mission and land."""
    await told("clear", getattr(drone, name).clear_mission())
    await told("land", drone.action.land())
    await told("disarmed", seen(drone.stream("armed"), lambda armed: not armed))


async def restart(drone: Drone) -> None:
    """Reboot: the same vehicle is found again, becomes well again, and can be armed."""
    await ready(drone)
    await told("land", drone.action.land())
    await flown(drone, "in land", "LAND")
    await told("reboot", drone.action.reboot())
    # What was last told of health may be from before; the mode after a start is another one.
    await told("first mode", seen(drone.stream("flight_mode"), lambda mode: mode.name != "LAND"))
    await ready(drone)
    await told("arm", drone.action.arm())
    await told("armed", seen(drone.stream("armed"), bool))
    await told("disarm", drone.action.disarm())
    await told("disarmed", seen(drone.stream("armed"), lambda armed: not armed))


SCENARIOS: Final[dict[str, Callable[[Drone], Awaitable[None]]]] = {
    "look": look,
    "configure": configure,
    "fly": fly,
    "restart": restart,
    "fly_mission": fly_mission,
    "fly_raw_mission": fly_raw_mission,
}
