"""What the motors draw in flight, by momentum theory (Leishman, "Principles of Helicopter Aerodynamics", ch. 2).

    P = P_hover (T / m g)^(3/2) + T V / efficiency,   V > 0

The first part makes the wake that carries the vehicle, and turns the blades; a tilt that holds against drag asks for
more thrust. The second is the work done on the way, with V the speed against the air along the thrust: m g v_z of a
climb, and drag times airspeed of level flight, which a hover in wind is as well. In a descent nothing is won: the rotor
sinks into its own wake.
"""

from math import sqrt
from typing import Final

MASS_KG: Final = 1.5
HOVER_W: Final = 140.0
MOTOR_EFFICIENCY: Final = 0.8
"""Mechanical over electrical power."""


def carrying_w(load: float) -> float:
    """Return the electrical power of a thrust, as a share of the weight, through still air."""
    return HOVER_W * load * sqrt(load) if load > 0.0 else 0.0


def moving_w(useful_w_kg: float) -> float:
    """Return the electrical power of specific thrust times speed along it, in W/kg."""
    return MASS_KG * max(useful_w_kg, 0.0) / MOTOR_EFFICIENCY
