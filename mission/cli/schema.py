"""``mission schema``: the JSON Schema of mission files."""

import json
from argparse import Namespace

from mission.cli.screen import out
from mission.spec.schema import mission_schema


def run(_: Namespace) -> int:
    """Print the schema."""
    out.out(json.dumps(mission_schema(), indent=2))
    return 0
