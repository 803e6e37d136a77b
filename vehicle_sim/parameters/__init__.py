"""The vehicle's parameters: a typed store, a table for each flavour, and the settings that they amount to."""

from vehicle_sim.parameters.actions import Action
from vehicle_sim.parameters.ardupilot import ARDUPILOT
from vehicle_sim.parameters.payload import ARDUPILOT_PAYLOAD, PX4_PAYLOAD
from vehicle_sim.parameters.protection import (
    ALL_FENCES,
    FenceSettings,
    FenceType,
    RallyChoice,
    RallySettings,
    WindSettings,
)
from vehicle_sim.parameters.px4 import PX4
from vehicle_sim.parameters.settings import BatteryThresholds, FlightSettings, YawBehaviour, flight_settings
from vehicle_sim.parameters.simulation import ARDUPILOT_SIMULATION, PX4_SIMULATION
from vehicle_sim.parameters.store import Flavour, Parameter, ParameterKind, ParameterStore

__all__ = [
    "ALL_FENCES",
    "Action",
    "BatteryThresholds",
    "FenceSettings",
    "FenceType",
    "Flavour",
    "FlightSettings",
    "Parameter",
    "ParameterKind",
    "ParameterStore",
    "RallyChoice",
    "RallySettings",
    "WindSettings",
    "YawBehaviour",
    "default_parameters",
    "flight_settings",
]


def default_parameters(flavour: Flavour) -> ParameterStore:
    """Return a store with all parameters of `flavour` at their defaults."""
    px4, ardupilot = (*PX4, *PX4_PAYLOAD, *PX4_SIMULATION), (*ARDUPILOT, *ARDUPILOT_PAYLOAD, *ARDUPILOT_SIMULATION)
    return ParameterStore(flavour, px4 if flavour is Flavour.PX4 else ardupilot)
