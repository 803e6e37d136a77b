"""Four rotors in a plus: Eq. 7, its inverse, and a mixer that stays within what rotors can do.

Body axes are forward-right-down; rotor 1 is in front, 2 on the right, 3 at the rear, 4 on the left. With squares of
speeds s_i = Omega_i^2, lift factor b, drag factor d and arm l (centre to rotor),

    U1 = b (s1 + s2 + s3 + s4)      thrust along body up
    U2 = b l (s4 - s2)              torque about forward: right side down
    U3 = b l (s1 - s3)              torque about right: nose up
    U4 = d (s1 - s2 + s3 - s4)      torque about down: nose to the right

U3 and U4 are the paper's with the opposite sign, because its axes are forward-left-up. Rotors 1 and 3 turn
counterclockwise seen from above, 2 and 4 clockwise; the air's drag turns the body the other way.
"""

from dataclasses import dataclass
from math import sqrt
from typing import Final

from vehicle_sim.dynamics.hover import MOST_THRUST_M_S2, ROTOR_TIME_S
from vehicle_sim.dynamics.power import MASS_KG, MOTOR_EFFICIENCY
from vehicle_sim.signals import FourRotors, Vector


@dataclass(frozen=True, slots=True, kw_only=True)
class RotorSet:
    """Body and rotors of a quadrotor, about those of a 1.5 kg survey vehicle with 10 inch propellers; SI units.

    Attributes:
        mass_kg: Of the whole vehicle.
        inertia_kg_m2: Principal moments about forward, right and down (3,).
        arm_m: From the centre to each rotor.
        rotor_inertia_kg_m2: Of one propeller with its motor's bell.
        lift: Thrust is this times the square of the speed, N s^2.
        drag: Torque is this times the square of the speed, N m s^2.
        unbalance_kg_m: Mass of a propeller times the distance of its centre from the axis: 0.1 g at 3 cm.
        most_speed_rad_s: Fastest speed of a sound rotor; by default the four then lift twice the weight.
        response_s: Time constant of the speed's first-order lag.
        motor_efficiency: Mechanical over electrical power.
    """

    mass_kg: float = MASS_KG
    inertia_kg_m2: Vector = (0.0291, 0.0291, 0.0552)
    arm_m: float = 0.25
    rotor_inertia_kg_m2: float = 6e-5
    lift: float = 1.6e-5
    drag: float = 2.56e-7
    unbalance_kg_m: float = 3e-6
    most_speed_rad_s: float = sqrt(MASS_KG * MOST_THRUST_M_S2 / (4.0 * 1.6e-5))
    response_s: float = ROTOR_TIME_S
    motor_efficiency: float = MOTOR_EFFICIENCY


SURVEY_ROTORS: Final = RotorSet()


def vibration_m_s2(outputs: FourRotors, rotors: RotorSet = SURVEY_ROTORS) -> tuple[float, float]:
    """Return the root mean square acceleration across and along the rotors' axes, of rotors with these `outputs`.

    An unbalanced rotor pulls with unbalance times the square of its speed, round and round; the four are not in
    phase, so their squares add. Along the axes, the blades' passing ripples the thrust, half as strongly.
    """
    pull = rotors.unbalance_kg_m * rotors.most_speed_rad_s**2 / rotors.mass_kg
    across = pull * sqrt(0.5 * sum(share * share for share in outputs))
    return across, 0.5 * across


def thrust_and_torques(squares: FourRotors, *, lift: float, drag: float, arm_m: float) -> FourRotors:
    """Return U1 (N) and U2, U3, U4 (N m) of four squared speeds (rad^2/s^2): Eq. 7 in forward-right-down axes."""
    front, right, rear, left = squares
    return (
        lift * (front + right + rear + left),
        lift * arm_m * (left - right),
        lift * arm_m * (front - rear),
        drag * (front - right + rear - left),
    )


def squares_for(wanted: FourRotors, *, lift: float, drag: float, arm_m: float) -> FourRotors:
    """Return the four squared speeds that give U1 to U4 of `wanted`: the inverse of `thrust_and_torques`.

    One that comes out negative cannot be flown; `mix` is what keeps to the limits.
    """
    thrust, roll, pitch, yaw = wanted
    even, across, along = thrust / (4.0 * lift), roll / (2.0 * lift * arm_m), pitch / (2.0 * lift * arm_m)
    turn = yaw / (4.0 * drag)
    return (even + along + turn, even - across - turn, even - along + turn, even + across - turn)


def mix(
    thrust: float, roll: float, pitch: float, yaw: float, *, least: float, most: float = 1.0
) -> tuple[FourRotors, bool]:
    """Return what each rotor is to give, within [least, most], and whether all that was asked for fits.

    All four demands are shares of one rotor's greatest thrust: `thrust` is added to every rotor, `pitch` to the front
    and taken from the rear, `roll` added on the left and taken on the right, `yaw` added to rotors 1 and 3 and taken
    from 2 and 4. Of what does not fit, yaw gives way first, then thrust, then roll and pitch: a vehicle that keeps its
    attitude can be flown out of trouble, one that only keeps its height or heading cannot.
    """
    front, right, rear, left = pitch, -roll, -pitch, roll
    fits = True
    spread = 2.0 * max(abs(pitch), abs(roll))
    if spread > most - least:
        scale, fits = (most - least) / spread, False
        front, right, rear, left = front * scale, right * scale, rear * scale, left * scale
    low, high = least - min(front, right, rear, left), most - max(front, right, rear, left)
    if thrust < low:
        thrust, fits = low, False
    elif thrust > high:
        thrust, fits = high, False
    front, right, rear, left = thrust + front, thrust + right, thrust + rear, thrust + left
    if yaw > 0.0:
        room = min(most - front, most - rear, right - least, left - least)
        if yaw > room:
            yaw, fits = max(room, 0.0), False
    else:
        room = min(front - least, rear - least, most - right, most - left)
        if -yaw > room:
            yaw, fits = min(-room, 0.0), False
    return (front + yaw, right - yaw, rear + yaw, left - yaw), fits
