"""MAVSDK 3 on one vehicle: `python -m tests.clients.mavsdk3_client udpout://HOST:PORT SCENARIO`.

This version speaks to a server of its own, `mavsdk_server`, over a local port; the server speaks MAVLink.
"""

import asyncio
import importlib
import socket
import sys

from mavsdk import System

from tests.clients.drone import Drone, seen, tell
from tests.clients.scenarios import SCENARIOS


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


async def main(address: str, scenario: str) -> None:
    system = System(port=free_port())
    await system.connect(system_address=address)
    try:
        await played(system, scenario)
    finally:
        system._stop_mavsdk_server()


async def played(system: System, scenario: str) -> None:
    state = await seen(system.core.connection_state(), lambda state: bool(state.is_connected))
    tell("connected", state.is_connected)
    await SCENARIOS[scenario](
        Drone(
            action=system.action,
            geofence=system.geofence,
            info=system.info,
            log_files=system.log_files,
            ftp=system.ftp,
            mission=system.mission,
            mission_raw=system.mission_raw,
            offboard=system.offboard,
            param=system.param,
            telemetry=system.telemetry,
            stream=lambda name: getattr(system.telemetry, name)(),
            flights=system.info.flight_information,
            progress=lambda plugin: getattr(system, plugin).mission_progress(),
            types=lambda plugin: importlib.import_module(f"mavsdk.{plugin}"),
            reports=system.events.health_and_arming_checks,
        )
    )
    tell("done")


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
