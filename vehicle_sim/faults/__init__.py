"""Faults on demand: what is wrong with the world and the vehicle's parts, by parameter, by schedule, by command."""

from vehicle_sim.faults.conditions import SOUND, Conditions, SensorState
from vehicle_sim.faults.fault_file import read_schedule
from vehicle_sim.faults.faults import Faults
from vehicle_sim.faults.injection import FailureType, FailureUnit
from vehicle_sim.faults.schedule import NO_FAULTS, FaultKind, Schedule, ScheduledFault, Since

__all__ = [
    "NO_FAULTS",
    "SOUND",
    "Conditions",
    "FailureType",
    "FailureUnit",
    "FaultKind",
    "Faults",
    "Schedule",
    "ScheduledFault",
    "SensorState",
    "Since",
    "read_schedule",
]
