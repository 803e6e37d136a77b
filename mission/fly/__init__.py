"""The flight: one loop around clock, link, session, monitor and record; and the bundled vehicle as a process."""

from mission.fly.interruption import StopRequest, StopSignals
from mission.fly.loop import fly
from mission.fly.options import FlightOptions
from mission.fly.result import FlightResult, Progress
from mission.fly.vehicle_process import BundledVehicle, VehicleOptions, home_for

__all__ = [
    "BundledVehicle",
    "FlightOptions",
    "FlightResult",
    "Progress",
    "StopRequest",
    "StopSignals",
    "VehicleOptions",
    "fly",
    "home_for",
]
