"""The vehicle's parameters: a typed store, a table for each flavour, and the settings that they amount to."""

from vehicle_sim.parameters.ardupilot import ARDUPILOT
from vehicle_sim.parameters.px4 import PX4
from vehicle_sim.parameters.settings import Action, BatteryThresholds, FlightSettings, YawBehaviour, flight_settings
from vehicle_sim.parameters.store import Flavour, Parameter, ParameterKind, ParameterStore

__all__ = [
    "Action",
    "BatteryThresholds",
    "Flavour",
    "FlightSettings",
    "Parameter",
    "ParameterKind",
    "ParameterStore",
    "YawBehaviour",
    "default_parameters",
    "flight_settings",
]


def default_parameters(flavour: Flavour) -> ParameterStore:
    """Return a store with all parameters of `flavour` at their defaults."""
    return ParameterStore(flavour, PX4 if flavour is Flavour.PX4 else ARDUPILOT)
