"""The vehicle's parameters: a typed store, a table for each flavour, and the settings that they amount to."""

from vehicle_sim.parameters.actions import Action
from vehicle_sim.parameters.protection import (
    ALL_FENCES,
    FenceSettings,
    FenceType,
    RallyChoice,
    RallySettings,
    WindSettings,
)
from vehicle_sim.parameters.settings import BatteryThresholds, FlightSettings, YawBehaviour, flight_settings
from vehicle_sim.parameters.store import Flavour, Parameter, ParameterKind, ParameterStore
from vehicle_sim.parameters.tables import default_parameters

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
