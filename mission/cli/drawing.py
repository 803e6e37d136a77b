"""Drawing pictures into a folder that a user names, in the format that is asked for."""

from pathlib import Path

from mission.cli.busy import doing
from mission.cli.inputs import unwritable
from mission.plan import FlightPlan
from mission.simulate import Simulation


def draw(folder: Path, form: str, plan: FlightPlan, simulation: Simulation | None = None) -> None:
    """Draw the pictures of a plan, or of a simulated flight of it, into a folder.

    Raises:
        SpecError: It cannot be written to.
    """
    try:
        with doing("drawing"):
            from mission.report.figures import save_all, save_simulated  # noqa: PLC0415 - loaded when it is asked for

            if simulation is None:
                save_all(plan, None, folder, (form,))
            else:
                save_simulated(plan, simulation, folder, (form,))
    except OSError as error:
        raise unwritable("--pictures", folder, error) from error
