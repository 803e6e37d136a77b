"""Schedules of one fault or more, written as a file has them."""

from vehicle_sim.faults import Schedule, read_schedule


def schedule_of(*faults: str) -> Schedule:
    """A schedule of faults such as ``gps_loss, since: takeoff, at_s: 5``."""
    return read_schedule(("faults: [" + ", ".join(f"{{fault: {fault}}}" for fault in faults) + "]").encode())
