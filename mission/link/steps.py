"""The steps of a flight as rows of a table: what is asked, what shows that it happened, how long it may take.

An acknowledgement never ends a step; only telemetry does. Times in steps are the vehicle's.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

from mission.link.fence_guard import FenceGuard
from mission.link.messages import disarm
from mission.link.pace import LEAST_RATE
from mission.link.values import Command, LandedState
from mission.link.vehicle_state import VehicleState
from mission.monitor.stage import Stage

FAILSAFE_PATIENCE_S: Final = 30.0
AIRBORNE_M: Final = 0.5
_GRACE_S: Final = 15.0
_TELLS_WITHIN_S: Final = 2.5
"""Two heartbeats, and one that was on its way."""


_FENCED_WITHIN_S: Final = 600.0
"""Vehicle time, which may be a simulator's that hurries: questions that are in vain end sooner, by the clock here."""


class Scene(NamedTuple):
    """What a step is judged by.

    Attributes:
        vehicle: The newest telemetry.
        in_step_s: How long the step has lasted.
        altitude_m: Height above the take-off point that is wanted.
        height_m: Height above the take-off point that is reported.
        climb_m_s: Vertical speed, upwards.
        off_m: Distance from the setpoint, horizontally; infinite before there is one.
        steady_s: How long the vehicle has been still, at the setpoint.
        left_s: What is left of the trajectory.
        disarmed_s: How long the motors have been seen disarmed.
    """

    vehicle: VehicleState
    in_step_s: float
    altitude_m: float
    height_m: float
    climb_m_s: float
    off_m: float
    steady_s: float
    left_s: float
    disarmed_s: float

    @property
    def airborne(self) -> bool:
        """Whether the vehicle has left the ground, by its own word or by its height."""
        flying = self.vehicle.landed in (LandedState.IN_AIR, LandedState.TAKEOFF, LandedState.LANDING)
        return self.vehicle.armed and (flying or self.height_m > AIRBORNE_M)

    @property
    def at_altitude(self) -> bool:
        """Whether the climb is over."""
        return self.height_m >= self.altitude_m - max(0.5, 0.1 * self.altitude_m) and abs(self.climb_m_s) < 0.5  # noqa: PLR2004 - m/s


def _never(_scene: Scene) -> bool:
    return False


@dataclass(frozen=True, kw_only=True)
class Step:
    """One row.

    Attributes:
        stage: Its name.
        command: What is asked; None where the vehicle does it by itself.
        confirmed: Whether telemetry shows that it has happened.
        missing: What has not happened, to be read after "the vehicle".
        limit_s: How long it may take.
        suffices: Whether to go on although the limit is reached.
        patience_s: How long a refusal is answered by asking again.
        repeat_s: After how long an accepted command without effect is given again.
        wait_s: How long to wait for the effect before asking for it.
        modes: Modes that the vehicle may be in meanwhile; any other, once armed, means that someone else flies.
        armed: Whether the motors must be armed all the while.
        streaming: Whether setpoints are streamed.
        at_once: Whether the command is given before the next heartbeat tells who flies.
    """

    stage: Stage
    confirmed: Callable[[Scene], bool]
    missing: str
    limit_s: float
    command: Callable[[Scene], Command] | None = None
    suffices: Callable[[Scene], bool] = _never
    patience_s: float = 0.0
    repeat_s: float = 3.0
    wait_s: float = 0.0
    modes: frozenset[int] | None = None
    armed: bool = False
    streaming: bool = False
    at_once: bool = False


def change_mode_step(stage: Stage, command: Command, mode: int, name: str, modes: frozenset[int] | None) -> Step:
    """Change the mode, and see it in a heartbeat."""
    return Step(
        stage=stage,
        command=lambda _scene: command,
        confirmed=lambda scene: scene.vehicle.mode == mode,
        missing=f"did not change to {name}",
        limit_s=15.0,
        patience_s=10.0,
        repeat_s=2.0,
        modes=modes,
    )


def fence_step(guard: FenceGuard) -> Step:
    """Wait until the vehicle keeps its geofence."""

    def is_set(_scene: Scene) -> bool:
        if guard.failure is not None:
            raise guard.failure
        return guard.is_set

    return Step(
        stage=Stage.FENCE,
        confirmed=is_set,
        missing="did not take its geofence",
        limit_s=_FENCED_WITHIN_S,
    )


def arm_steps(command: Command, modes: frozenset[int]) -> tuple[Step, ...]:
    """Wait for the vehicle's own checks, then arm; a refusal may still be about something that passes."""
    return (
        Step(
            stage=Stage.CHECKS,
            confirmed=lambda scene: scene.vehicle.armable,
            missing="does not pass its checks before arming",
            limit_s=FAILSAFE_PATIENCE_S,
            suffices=lambda _scene: True,  # asking makes it say why
            modes=modes,
        ),
        Step(
            stage=Stage.ARM,
            command=lambda _scene: command,
            confirmed=lambda scene: scene.vehicle.armed,
            missing="did not arm",
            limit_s=FAILSAFE_PATIENCE_S + 10.0,
            patience_s=FAILSAFE_PATIENCE_S,
            modes=modes,
        ),
    )


def climb_step(modes: frozenset[int], altitude_m: float, end_mode: int) -> Step:
    """Wait until the altitude is reached and the mode is the one that a take-off ends in."""
    return Step(
        stage=Stage.CLIMB,
        confirmed=lambda scene: scene.at_altitude and scene.vehicle.mode == end_mode,
        missing=f"did not climb to {altitude_m:g} m",
        limit_s=30.0 + 4.0 * altitude_m,
        suffices=lambda scene: scene.at_altitude,
        modes=modes,
        armed=True,
    )


def flight_steps(modes: frozenset[int], duration_s: float) -> tuple[Step, ...]:
    """Settle at the start, fly the trajectory, arrive: all under streamed setpoints."""
    return (
        Step(
            stage=Stage.SETTLE,
            confirmed=lambda scene: scene.steady_s >= 1.0,
            missing="did not come to rest at the start of the trajectory, with its nose where it should be,",
            limit_s=20.0,
            suffices=lambda scene: scene.off_m <= 2.0,  # noqa: PLR2004 - m: no more than good tracking in wind
            modes=modes,
            armed=True,
            streaming=True,
        ),
        Step(
            stage=Stage.FLY,
            confirmed=lambda scene: scene.left_s <= 0.0,
            missing="did not come to the end of the trajectory",
            limit_s=duration_s / LEAST_RATE + 60.0,
            modes=modes,
            armed=True,
            streaming=True,
        ),
        Step(
            stage=Stage.ARRIVE,
            confirmed=lambda scene: scene.steady_s >= 1.0,
            missing="did not come to rest",
            limit_s=5.0,
            suffices=lambda _scene: True,
            modes=modes,
            armed=True,
            streaming=True,
        ),
    )


def landing_steps(command: Command, land_mode: int, before: frozenset[int], altitude_m: float) -> tuple[Step, ...]:
    """Land on the spot, until the ground carries the vehicle and its motors are off.

    Setpoints go on until the mode has changed: a vehicle that stops hearing them would call it a failure.
    """
    on_ground = (LandedState.ON_GROUND, LandedState.UNDEFINED)
    return (
        Step(
            stage=Stage.LAND,
            command=lambda _scene: command,
            confirmed=lambda scene: scene.vehicle.mode == land_mode or not scene.vehicle.armed,
            missing="did not begin to land",
            limit_s=15.0,
            patience_s=10.0,
            modes=before | {land_mode},
            streaming=True,
        ),
        Step(
            stage=Stage.TOUCH_DOWN,
            confirmed=lambda scene: scene.vehicle.landed is LandedState.ON_GROUND or not scene.vehicle.armed,
            missing="did not touch down",
            limit_s=60.0 + 8.0 * altitude_m,
            modes=frozenset({land_mode}),
        ),
        disarm_step(
            frozenset({land_mode}),
            # ArduPilot says "landing" for a moment after it has disarmed.
            settled=lambda scene: scene.vehicle.landed in on_ground or scene.disarmed_s > 3.0,  # noqa: PLR2004 - s
            wait_s=_GRACE_S,
        ),
    )


def disarm_step(
    modes: frozenset[int] | None, settled: Callable[[Scene], bool] = lambda _scene: True, wait_s: float = 0.0
) -> Step:
    """Stop the motors on the ground; vehicles do it by themselves after a landing, if they are given the time."""
    return Step(
        stage=Stage.DISARM,
        command=lambda _scene: disarm(),
        confirmed=lambda scene: not scene.vehicle.armed and settled(scene),
        missing="did not disarm",
        limit_s=wait_s + 25.0,
        patience_s=wait_s + 20.0,
        wait_s=wait_s,
        modes=modes,
    )


def unarm_step() -> Step:
    """Disarm a vehicle that was asked to arm and has not told what came of it; heartbeats that follow tell."""
    return disarm_step(None, settled=lambda scene: scene.in_step_s > _TELLS_WITHIN_S)
