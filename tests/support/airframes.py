"""Controller and airframe with nothing between them: what the vehicle flies like with perfect sensors."""

from vehicle_sim.control.controller import Controller, TrackingGains
from vehicle_sim.control.rotor_control import RotorControl
from vehicle_sim.dynamics.airframe import Airframe, Dynamics
from vehicle_sim.dynamics.hover import Hover
from vehicle_sim.dynamics.quadrotor import Quadrotor
from vehicle_sim.estimator.estimator import _NOTHING
from vehicle_sim.signals import Command, Estimate, FourRotors, Guidance, Limits, Motion, Setpoint, Vector

STEP_S = 0.01
LIMITS = Limits(
    speed_m_s=10.0,
    climb_m_s=2.5,
    descent_m_s=1.5,
    acceleration_m_s2=4.0,
    braking_m_s2=3.0,
    vertical_acceleration_m_s2=2.0,
    tilt_rad=0.5,
    yaw_rate_rad_s=1.0,
)


def perfect(motion: Motion) -> Estimate:
    """An estimate without error."""
    return Estimate(
        0.0,
        None,
        motion.position_ned_m,
        motion.velocity_ned_m_s,
        motion.acceleration_ned_m_s2,
        motion.roll_rad,
        motion.pitch_rad,
        motion.yaw_rad,
        motion.rates_rad_s,
        _NOTHING,
    )


class PerfectFlight:
    """One airframe under control; `wind` and `limits` may be changed at any time, `outputs` keeps what rotors gave."""

    def __init__(self, dynamics: Dynamics, *, gains: TrackingGains | None = None, limits: Limits = LIMITS) -> None:
        self.is_full = dynamics is Dynamics.QUADROTOR
        self.airframe: Airframe = Quadrotor(step_s=STEP_S) if self.is_full else Hover(step_s=STEP_S)
        self.controller = Controller(TrackingGains() if gains is None else gains, step_s=STEP_S)
        self.rotors = RotorControl(step_s=STEP_S)
        self.limits = limits
        self.wind: Vector = (0.0, 0.0, 0.0)
        self.outputs: list[FourRotors] = []

    def command(self, setpoint: Setpoint | None) -> Command:
        """What is asked of the airframe next."""
        estimate = perfect(self.airframe.motion)
        command = self.controller.step(estimate, Guidance(setpoint, self.limits))
        return self.rotors.step(command, estimate) if self.is_full else command

    def fly(self, setpoint: Setpoint | None, seconds: float) -> list[Motion]:
        """Fly `setpoint` and return the motion after each step."""
        motions = []
        for _ in range(round(seconds / STEP_S)):
            command = self.command(setpoint)
            self.outputs.append(command.outputs)
            motions.append(self.airframe.step(command, self.wind))
        return motions
