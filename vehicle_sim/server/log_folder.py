"""The folder that keeps the vehicle's logs: each is written whole once it has ended, and no older file is replaced."""

import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Final

from vehicle_sim.errors import ConfigurationError
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.flight_log import FlightLog
from vehicle_sim.server.whole_file import write_whole

_NAME: Final = re.compile(r"system([0-9]+)-([0-9]+)\.tlog")


def keep_logs(folder: Path, endpoints: Sequence[Endpoint], notify: Callable[[str], None]) -> None:
    """Write each log that ends from now on to `systemID-NUMBER.tlog`; in flight, `notify` is told where it cannot be.

    Raises:
        ConfigurationError: There is no such folder and it cannot be made.
    """
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise ConfigurationError(f"{folder}: {error.strerror or error}; name a folder for the logs") from error
    for endpoint in endpoints:
        endpoint.recorder.on_finished = partial(_keep, folder, endpoint, notify)


def _keep(folder: Path, endpoint: Endpoint, notify: Callable[[str], None], log: FlightLog) -> None:
    system_id = endpoint.system_id
    try:
        found = [_NAME.fullmatch(path.name) for path in folder.iterdir()]
        numbers = [int(name[2]) for name in found if name is not None and int(name[1]) == system_id]
        write_whole(folder / f"system{system_id}-{max(numbers, default=0) + 1:04d}.tlog", bytes(log.data))
    except OSError as error:
        notify(f"{folder}: {error.strerror or error}; log {log.number} is not kept there")
