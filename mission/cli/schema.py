"""``mission schema``: the JSON Schema of mission files, and their keys as tables."""

import json
from argparse import Namespace

from mission.cli.screen import out
from mission.spec.key_tables import tables
from mission.spec.schema import mission_schema


def run(arguments: Namespace) -> int:
    """Print the schema, or the tables."""
    if arguments.markdown:
        out.out(tables(), end="")
    else:
        out.out(json.dumps(mission_schema(), indent=2))
    return 0
