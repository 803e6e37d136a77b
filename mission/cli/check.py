"""``mission check``: report every fault of mission files, and whether each has a plan."""

from argparse import Namespace

from mission.cli.screen import count, out, print_error
from mission.errors import MissionError
from mission.plan import plan_mission
from mission.spec.loader import load_mission


def run(arguments: Namespace) -> int:
    """Check each file; the exit code is that of the worst of them."""
    worst = 0
    for name in arguments.files:
        try:
            spec = load_mission(name)
            plan = plan_mission(spec)
        except MissionError as error:
            print_error(error, source=name)
            worst = max(worst, error.exit_code)
            continue
        out.print(
            f"{name}: sound; {count(plan.partition.size, 'triangle')}, {count(plan.shortest_runs, 'shortest run')}, "
            f"{plan.path.length_m:.1f} m in {plan.trajectory.duration_s:.0f} s, proved",
            markup=False,
        )
    return worst
