"""Print the lowest admitted version of each direct requirement, as constraints for pip."""

import re
import tomllib
from pathlib import Path

project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
for requirement in project["dependencies"] + project["optional-dependencies"]["test"]:
    match = re.fullmatch(r"([A-Za-z0-9_.-]+)>=([0-9.]+)", requirement)
    if match is None:
        message = f"no lower bound to test: {requirement!r}"
        raise SystemExit(message)
    print(f"{match[1]}=={match[2]}")  # noqa: T201 - printing is what this is for
