"""The failures of the vehicle program, one class for each kind."""


class VehicleSimError(Exception):
    """Base of every failure that the vehicle raises on purpose."""


class ConfigurationError(VehicleSimError):
    """An option or address that cannot be used; the message says what to write instead."""


class ParameterError(VehicleSimError):
    """A parameter that does not exist, or a value that it cannot take; the message says which."""


class PlanError(VehicleSimError):
    """A plan whose items do not make sense together; the message says what is wrong."""
