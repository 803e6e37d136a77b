"""One vehicle: airframe, wind, sensors, estimator, controller and autopilot, composed at a fixed step."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import cos, hypot, isfinite, sin
from typing import Final, NamedTuple

from vehicle_sim.autopilot import Autopilot, Mode
from vehicle_sim.battery import Battery
from vehicle_sim.camera import camera_of
from vehicle_sim.clock import StepClock
from vehicle_sim.control.controller import PX4_GAINS, Controller, TrackingGains
from vehicle_sim.control.rotor_control import RotorControl
from vehicle_sim.dynamics.airframe import Airframe, Dynamics
from vehicle_sim.dynamics.hover import DRAG_PER_S, MOST_THRUST_M_S2, Hover
from vehicle_sim.dynamics.quadrotor import Quadrotor
from vehicle_sim.dynamics.rotors import vibration_m_s2
from vehicle_sim.dynamics.wind import Wind
from vehicle_sim.errors import ConfigurationError
from vehicle_sim.estimator import Estimator, EstimatorTuning
from vehicle_sim.estimator.process import NavigationTuning
from vehicle_sim.faults import NO_FAULTS, Faults, Schedule
from vehicle_sim.geodesy import geodetic_at
from vehicle_sim.noise import Normals
from vehicle_sim.parameters import Flavour, ParameterStore, default_parameters, flight_settings
from vehicle_sim.sensors import SensorErrors, Sensors
from vehicle_sim.signals import (
    BaroReading,
    CompassReading,
    Estimate,
    Geodetic,
    GpsReading,
    ImuReading,
    Motion,
    Vector,
)

_WIND: Final = 5
_AUTOPILOT_HZ: Final = 20.0
_LONGEST_STEP_S: Final = 0.02
_STRONGEST_WIND_M_S: Final = 30.0
_STRONGEST_GUST_M_S: Final = 10.0
_MOST_DRAG_PER_S: Final = 5.0


class Readings(NamedTuple):
    """The latest reading of each sensor; None before its first."""

    imu: ImuReading
    gps: GpsReading | None
    baro: BaroReading | None
    compass: CompassReading | None


@dataclass(frozen=True, slots=True, kw_only=True)
class VehicleConfig:
    """What makes one vehicle different from another.

    Raises:
        ConfigurationError: A value that no vehicle can have.
    """

    seed: int = 1
    flavour: Flavour = Flavour.ARDUPILOT
    dynamics: Dynamics = Dynamics.HOVER
    home_lat_deg: float = 47.397742
    home_lon_deg: float = 8.545594
    home_alt_m: float = 488.0
    home_yaw_rad: float = 0.0
    step_s: float = 0.01
    wind_m_s: float = 0.0
    wind_from_deg: float = 180.0
    gust_m_s: float = 0.0
    drag_per_s: float = DRAG_PER_S
    gains: TrackingGains = field(default_factory=TrackingGains)
    sensor_errors: SensorErrors = field(default_factory=SensorErrors)
    estimator: EstimatorTuning = field(default_factory=EstimatorTuning)
    faults: Schedule = NO_FAULTS

    def __post_init__(self) -> None:
        """Refuse what cannot be simulated."""
        if not isinstance(self.flavour, Flavour):
            raise ConfigurationError(f"a flavour is one of Flavour's members, not {self.flavour!r}")
        if not isinstance(self.dynamics, Dynamics):
            raise ConfigurationError(f"dynamics are one of Dynamics' members, not {self.dynamics!r}")
        if self.seed < 0:
            raise ConfigurationError(f"a seed is a whole number from 0 up, not {self.seed}")
        # The poles themselves have no east.
        if not (abs(self.home_lat_deg) < 90.0 and abs(self.home_lon_deg) <= 180.0 and isfinite(self.home_alt_m)):  # noqa: PLR2004 - degrees
            raise ConfigurationError(
                f"home is LAT,LON,ALT with -90 < LAT < 90 and -180 <= LON <= 180, "
                f"not {self.home_lat_deg},{self.home_lon_deg},{self.home_alt_m}"
            )
        if not 0.0 < self.step_s <= _LONGEST_STEP_S:
            raise ConfigurationError(f"the step lies in (0, {_LONGEST_STEP_S}] s, not {self.step_s}")
        if not (0.0 <= self.wind_m_s <= _STRONGEST_WIND_M_S and 0.0 <= self.gust_m_s <= _STRONGEST_GUST_M_S):
            raise ConfigurationError(
                f"wind is 0 to {_STRONGEST_WIND_M_S:g} m/s with gusts of 0 to {_STRONGEST_GUST_M_S:g} m/s, "
                f"not {self.wind_m_s:g} and {self.gust_m_s:g}"
            )
        if not 0.0 < self.drag_per_s <= _MOST_DRAG_PER_S:
            raise ConfigurationError(f"drag lies in (0, {_MOST_DRAG_PER_S:g}] per second, not {self.drag_per_s:g}")
        if not isfinite(self.wind_from_deg):
            raise ConfigurationError("the wind comes from a direction in degrees")

    @property
    def home(self) -> Geodetic:
        """The place where the vehicle stands at boot."""
        return Geodetic(self.home_lat_deg, self.home_lon_deg, self.home_alt_m)


AS_THEY_COME: Final[Mapping[Flavour, VehicleConfig]] = {
    # It leans by 11.9 degrees at 5.06 m/s, and its sensors are nearly without errors.
    Flavour.ARDUPILOT: VehicleConfig(
        flavour=Flavour.ARDUPILOT,
        drag_per_s=0.41,
        gains=TrackingGains(observer_s=0.7),
        sensor_errors=SensorErrors(
            accelerometer_noise_m_s2=0.02,
            accelerometer_bias_m_s2=0.01,
            gyro_noise_rad_s=0.0005,
            gyro_bias_rad_s=0.001,
            gps_noise_m=0.01,
            gps_vertical_noise_m=0.02,
            gps_wander_m=0.01,
            gps_vertical_wander_m=0.01,
            gps_velocity_noise_m_s=0.01,
            baro_noise_m=0.02,
            baro_wander_m=0.02,
            compass_noise_rad=0.002,
            compass_bias_rad=0.002,
        ),
        estimator=EstimatorTuning(
            navigation=NavigationTuning(
                acceleration_m_s2=0.02,
                acceleration_bias_m_s2=0.01,
                acceleration_bias_walk=4e-4,
                levelling_noise_m_s2=0.002,
                tilt_walk_m_s2=0.0006,
                tilt_drift_m_s3=0.0005,
                tilt_drift_walk=1e-4,
                heading_rad=0.003,
                velocity_start_m_s=0.01,
                gps_noise_m=0.01,
                gps_vertical_noise_m=0.02,
                gps_wander_m=0.01,
                gps_vertical_wander_m=0.01,
                gps_velocity_noise_m_s=0.01,
                baro_noise_m=0.02,
                baro_walk=0.004,
            )
        ),
    ),
    # It leans by 23.8 degrees at 4.56 m/s (SIH_KDV over SIH_MASS is 1). Noise of the inertial unit at 250 Hz is
    # (0.5, 1.7, 1.4) m/s^2 and (0.14, 0.07, 0.03) rad/s, here of equal density; that of the receiver (0.2, 0.2, 0.5) m.
    Flavour.PX4: VehicleConfig(
        flavour=Flavour.PX4,
        drag_per_s=0.95,
        gains=PX4_GAINS,
        sensor_errors=SensorErrors(
            accelerometer_noise_m_s2=0.4,
            gyro_noise_rad_s=0.04,
            gps_vertical_noise_m=0.5,
            gps_wander_m=0.05,
            gps_vertical_wander_m=0.05,
            gps_velocity_noise_m_s=0.1,
            baro_noise_m=0.25,
            baro_wander_m=0.05,
        ),
        estimator=EstimatorTuning(
            navigation=NavigationTuning(
                acceleration_m_s2=0.4,
                levelling_noise_m_s2=0.03,
                tilt_walk_m_s2=0.04,
                gps_vertical_noise_m=0.5,
                gps_wander_m=0.05,
                gps_vertical_wander_m=0.05,
                gps_velocity_noise_m_s=0.1,
                baro_noise_m=0.25,
                baro_walk=0.01,
            )
        ),
    ),
}
"""The vehicle that each autopilot's own simulator flies: ArduCopter 4.7 (frame X) and PX4 1.17 (SIH quadrotor)."""


class Vehicle:
    """A vehicle that stands at its home at vehicle time 0 and goes on by one fixed step at each call of `step`.

    Two vehicles with equal configurations that receive the same requests at the same steps behave identically, bit
    for bit.
    """

    def __init__(self, config: VehicleConfig, parameters: ParameterStore | None = None) -> None:
        """Switch on; `parameters` default to the flavour's.

        Raises:
            ConfigurationError: The parameters belong to another flavour.
        """
        self.config = config
        self.parameters = default_parameters(config.flavour) if parameters is None else parameters
        if self.parameters.flavour is not config.flavour:
            raise ConfigurationError(f"parameters of {self.parameters.flavour} for a vehicle of {config.flavour}")
        step_s = config.step_s
        kind = Quadrotor if config.dynamics is Dynamics.QUADROTOR else Hover
        self.airframe: Airframe = kind(step_s=step_s, yaw_rad=config.home_yaw_rad, drag_per_s=config.drag_per_s)
        if config.wind_m_s > 0.0 or config.gust_m_s > 0.0:
            self.parameters.set("SIM_WIND_SPD", config.wind_m_s)
            self.parameters.set("SIM_WIND_DIR", config.wind_from_deg % 360.0)
            self.parameters.set("SIM_WIND_TURB", config.gust_m_s)
        self._wind = Wind(Normals(config.seed, _WIND), gust_m_s=self.parameters["SIM_WIND_TURB"], step_s=step_s)
        self.battery = Battery()
        self._boot()
        self._autopilot_steps = max(1, round(1.0 / (_AUTOPILOT_HZ * step_s)))
        self.faults = Faults(self.parameters, config.faults)
        self._resting_v = self.faults.conditions.resting_v
        self._suffer()
        self.wind_ned_m_s = self._wind.steady_ned_m_s
        self.parameters.watch(self._obey)

    def _boot(self) -> None:
        """Start what runs on the flight controller, at vehicle time 0."""
        config, step_s = self.config, self.config.step_s
        self._clock = StepClock(step_s)
        self._sensors = Sensors(config.sensor_errors, seed=config.seed, home=config.home, step_s=step_s)
        self._estimator = Estimator(config.estimator, step_s=step_s)
        self._controller = Controller(config.gains, step_s=step_s)
        self._rotors = RotorControl(step_s=step_s) if config.dynamics is Dynamics.QUADROTOR else None
        self._command = self._controller.command
        self.autopilot = Autopilot(
            config.flavour, flight_settings(self.parameters), self.battery, self._estimator.estimate
        )
        self.camera = camera_of(self.parameters)

    def _obey(self) -> None:
        """Let a parameter be in force from the moment that it is set: a request may follow before the next step."""
        settings = flight_settings(self.parameters)
        if settings != self.autopilot.settings:
            self.battery.judge(settings.battery_thresholds)
            self.autopilot.configure(settings)

    def reboot(self) -> None:
        """Restart the flight controller: its clock, sensors, estimator and modes begin anew, where the vehicle is.

        What is no software stays as it is (the airframe, the charge of the battery, the wind, what is wrong with
        sensors), and so does what is stored: parameters, mission, fence and rally points.
        """
        before = self.autopilot
        self._boot()
        self.autopilot.take_over(before)
        self.faults.reboot()
        self._suffer()

    @property
    def steps(self) -> int:
        """Steps since boot."""
        return self._clock.steps

    @property
    def time_s(self) -> float:
        """Vehicle time since boot, in seconds."""
        return self._clock.now_s()

    @property
    def time_boot_ms(self) -> int:
        """Vehicle time since boot, in whole milliseconds."""
        return round(self._clock.now_s() * 1000.0)

    @property
    def truth(self) -> Motion:
        """The true motion, relative to `config.home`."""
        return self.airframe.motion

    @property
    def true_place(self) -> Geodetic:
        """Where the vehicle really is."""
        return geodetic_at(self.config.home, self.airframe.motion.position_ned_m)

    @property
    def estimate(self) -> Estimate:
        """What the vehicle believes of itself."""
        return self._estimator.estimate

    @property
    def readings(self) -> Readings:
        """The latest reading of each sensor."""
        sensors = self._sensors
        return Readings(sensors.imu, sensors.gps, sensors.baro, sensors.compass)

    @property
    def thrust(self) -> float:
        """Thrust of all rotors as a share of the greatest, 0 to 1."""
        return self.airframe.thrust_m_s2 / MOST_THRUST_M_S2

    @property
    def vibration_m_s2(self) -> Vector:
        """Root mean square of the shaking along forward, right and down: the rotors' and the accelerometers' noise."""
        noise = self.config.sensor_errors.accelerometer_noise_m_s2
        across, along = vibration_m_s2(self.airframe.outputs)
        return (hypot(across, noise), hypot(across, noise), hypot(along, noise))

    @property
    def attitude_target_rad(self) -> Vector:
        """Roll, pitch and yaw that the controller asks for."""
        north, east = self._controller.tilt_ne_rad
        yaw = self._estimator.estimate.yaw_rad
        ahead, aside = north * cos(yaw) + east * sin(yaw), east * cos(yaw) - north * sin(yaw)
        return (aside, -ahead, self._controller.yaw_rad)

    @property
    def thrust_target(self) -> float:
        """Thrust that the controller asks for as a share of the greatest, from 0 up."""
        return self._controller.command.thrust_m_s2 / MOST_THRUST_M_S2

    @property
    def attitude_corrections(self) -> tuple[Vector, float, float]:
        """Drift of the gyros in rad/s that is taken out, and the last corrections of tilt and yaw in radians."""
        return self._estimator.attitude_corrections

    @property
    def wind_estimate_ne_m_s(self) -> tuple[float, float] | None:
        """The wind that the observed disturbance amounts to, if all of it is drag; None while nothing is flown."""
        return None if self.autopilot.target is None else self._felt_wind(self._estimator.estimate)[:2]

    def step(self) -> None:
        """Advance by exactly one step."""
        time_s = self._clock.advance()
        steps = self._clock.steps
        self.wind_ned_m_s = self._wind.step()
        before = self.airframe.motion
        motion = self.airframe.step(self._command, self.wind_ned_m_s)
        if motion.on_ground and not before.on_ground:
            self.autopilot.hit_ground(before.velocity_ned_m_s[2])
        sensors = self._sensors
        sensors.sample(steps, time_s, motion)
        estimate = self._estimator.step(time_s, sensors.imu, sensors.new_gps, sensors.new_baro, sensors.new_compass)
        self.autopilot.observe(time_s, estimate)
        if steps % self._autopilot_steps == 0:
            power_w, for_s = self.airframe.power_w, self._autopilot_steps * self.config.step_s
            self.battery.drain(power_w, for_s, self.autopilot.settings.battery_thresholds)
            if self.faults.advance(time_s, armed=self.autopilot.armed, flying=self.autopilot.flying):
                self._suffer()
            self.autopilot.advance(self._command.thrust_m_s2, self._felt_wind(estimate))
        self._photograph(estimate)
        command = self._controller.step(estimate, self.autopilot.guidance)
        self._command = command if self._rotors is None else self._rotors.step(command, estimate)

    def _photograph(self, estimate: Estimate) -> None:
        """Pass on what the mission asks of the camera, and let it look."""
        camera, orders = self.camera, self.autopilot.camera_orders
        while orders:
            order = orders.popleft()
            if camera is not None:
                camera.take(order)
        if camera is not None:
            camera.step(estimate, in_mission=self.autopilot.mode is Mode.AUTO)

    def _felt_wind(self, estimate: Estimate) -> Vector:
        """Return the level wind whose drag explains the disturbance that the controller sees."""
        north, east, _down = self._controller.disturbance_ned_m_s2
        v_north, v_east, _v_down = estimate.velocity_ned_m_s
        drag_per_s = self.config.drag_per_s
        return (v_north + north / drag_per_s, v_east + east / drag_per_s, 0.0)

    def _suffer(self) -> None:
        """Hand what is wrong now to those that suffer from it."""
        conditions = self.faults.conditions
        self._wind.steady_ned_m_s = conditions.wind_ned_m_s
        self._wind.set_gusts(conditions.gust_m_s)
        self.airframe.weaken(conditions.efficiencies)
        self._sensors.suffer(conditions)
        self.autopilot.pilot.receive(() if conditions.radio_lost else conditions.radio_us)
        if conditions.resting_v != self._resting_v:
            self._resting_v = conditions.resting_v
            self.battery.rest_at(conditions.resting_v, self.autopilot.settings.battery_thresholds.capacity_mah)
