"""Weak rotors of a vehicle whose model has no rotors: what their mixer would have asked of each, and what they give.

A mixer shares specific thrust T and angular accelerations (p, q, r) out to four rotors in a plus (Eq. 7),

    f_i = T / 4 + (x_i q - y_i p) / (2 k) + d_i r / (4 k_yaw),

with x_i, y_i in {-1, 0, 1} forward and right, and d_i = +-1 the sense of the reaction torque. Rotor i gives e_i f_i,
within what a rotor can do; thrust and accelerations are then the sums that undo the sharing. With all e_i = 1 nothing
changes.
"""

from typing import Final

from vehicle_sim.signals import GRAVITY_M_S2, Command, FourRotors

SOUND_ROTORS: Final[FourRotors] = (1.0, 1.0, 1.0, 1.0)
"""All rotors give what they are asked for; 1 front, 2 right, 3 rear, 4 left."""

_FORWARD: Final = (1.0, 0.0, -1.0, 0.0)
_RIGHT: Final = (0.0, 1.0, 0.0, -1.0)
_TURN: Final = (1.0, -1.0, 1.0, -1.0)
LEVER_PER_M: Final = 12.9
"""Arm over squared radius of gyration about roll and pitch: 0.25 m at 1.5 kg and 0.0291 kg m^2."""

TURN_PER_M: Final = 0.435
"""The same for the reaction torque about yaw: 0.016 m at 1.5 kg and 0.0552 kg m^2."""

MOST_ROTOR_M_S2: Final = 0.5 * GRAVITY_M_S2


def weakened(command: Command, efficiency: FourRotors) -> Command:
    """Return what rotors of these efficiencies make of `command`."""
    p, q, r = command.angular_acceleration_rad_s2
    share, roll, pitch, yaw = command.thrust_m_s2 / 4.0, p / LEVER_PER_M, q / LEVER_PER_M, r / TURN_PER_M
    thrust = up_p = up_q = up_r = 0.0
    for x, y, d, rotor in zip(_FORWARD, _RIGHT, _TURN, efficiency, strict=True):
        wanted = share + (x * pitch - y * roll) / 2.0 + d * yaw / 4.0
        force = rotor * min(max(wanted, 0.0), MOST_ROTOR_M_S2)
        thrust += force
        up_p -= y * force
        up_q += x * force
        up_r += d * force
    return Command(thrust, (LEVER_PER_M * up_p, LEVER_PER_M * up_q, TURN_PER_M * up_r))
