"""What every airframe offers, whichever equations move it."""

from enum import StrEnum
from typing import Protocol

from vehicle_sim.signals import Command, FourRotors, Motion, Vector


class Dynamics(StrEnum):
    """Which equations of motion the vehicle has."""

    HOVER = "hover"
    QUADROTOR = "quadrotor"


class Airframe(Protocol):
    """A body that rotors carry, standing on level ground until they lift it.

    Rotors are numbered as in Eq. 7: 1 front, 2 right, 3 rear, 4 left.
    """

    motion: Motion
    """The true motion after the last step, relative to where the airframe stood first."""

    @property
    def thrust_m_s2(self) -> float:
        """Specific thrust that the rotors give now, along body up."""
        ...

    @property
    def outputs(self) -> FourRotors:
        """Thrust of each rotor as a share, 0 to 1, of what a sound one can give."""
        ...

    @property
    def power_w(self) -> float:
        """Electrical power that the motors draw now."""
        ...

    def weaken(self, efficiency: FourRotors) -> None:
        """From now on each rotor gives this share, 0 to 1, of the thrust that it is asked for.

        Raises:
            ValueError: A share does not lie in [0, 1].
        """
        ...

    def step(self, command: Command, wind_ned_m_s: Vector) -> Motion:
        """Go on by one step under `command` and in wind, both held, and return the new motion."""
        ...


def checked_efficiency(efficiency: FourRotors) -> FourRotors:
    """Return `efficiency` if each share lies in [0, 1].

    Raises:
        ValueError: One does not.
    """
    if not all(0.0 <= share <= 1.0 for share in efficiency):
        raise ValueError(f"the efficiency of a rotor lies in [0, 1], not {efficiency}")
    return efficiency
