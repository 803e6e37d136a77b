"""The paper's own closed loop (Eq. 5, 10 to 12), without sensors, an autopilot, or MAVLink."""

from mission.simulate.closed_loop import SETTLED, Simulation, judged, simulate_plan

__all__ = ["SETTLED", "Simulation", "judged", "simulate_plan"]
