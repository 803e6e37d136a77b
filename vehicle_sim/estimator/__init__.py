"""State estimation: attitude from the gyros, position and velocity from a Kalman filter."""

from vehicle_sim.estimator.estimator import Estimator, EstimatorTuning
from vehicle_sim.estimator.process import NavigationTuning

__all__ = ["Estimator", "EstimatorTuning", "NavigationTuning"]
