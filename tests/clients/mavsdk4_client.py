"""MAVSDK 4 on one vehicle: `python -m tests.clients.mavsdk4_client udpout://HOST:PORT SCENARIO`.

This version speaks MAVLink from within the process, through a native library.
"""

import asyncio
import importlib
import sys

from mavsdk.asyncio import ComponentType, Configuration, Mavsdk
from mavsdk.asyncio.plugins.action import ActionAsync
from mavsdk.asyncio.plugins.ftp import FtpAsync
from mavsdk.asyncio.plugins.geofence import GeofenceAsync
from mavsdk.asyncio.plugins.info import InfoAsync
from mavsdk.asyncio.plugins.log_files import LogFilesAsync
from mavsdk.asyncio.plugins.mission import MissionAsync
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.offboard import OffboardAsync
from mavsdk.asyncio.plugins.param import ParamAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync

from tests.clients.drone import PATIENCE_S, Drone, tell
from tests.clients.scenarios import SCENARIOS


async def main(address: str, scenario: str) -> None:
    async with Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION)) as mavsdk:
        await mavsdk.add_any_connection(address)
        system = await mavsdk.first_autopilot(timeout_s=PATIENCE_S)
        if system is None:
            raise TimeoutError("no autopilot was found")
        tell("connected", await system.is_connected())
        tell("autopilot", await system.autopilot_type())
        tell("vehicle", await system.vehicle_type())
        tell("system", [await system.get_system_id(), await system.component_ids()])
        telemetry, info = TelemetryAsync(system), InfoAsync(system)
        missions = {"mission": MissionAsync(system), "mission_raw": MissionRawAsync(system)}
        await SCENARIOS[scenario](
            Drone(
                action=ActionAsync(system),
                geofence=GeofenceAsync(system),
                info=info,
                log_files=LogFilesAsync(system),
                ftp=FtpAsync(system),
                mission=missions["mission"],
                mission_raw=missions["mission_raw"],
                offboard=OffboardAsync(system),
                param=ParamAsync(system),
                telemetry=telemetry,
                stream=lambda name: getattr(telemetry, f"subscribe_{name}")(),
                flights=info.subscribe_flight_information,
                progress=lambda plugin: missions[plugin].subscribe_mission_progress(),
                types=lambda plugin: importlib.import_module(f"mavsdk.asyncio.plugins.{plugin}"),
            )
        )
        tell("done")


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
