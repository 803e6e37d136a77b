"""The file that keeps the parameters over restarts: read once at the start, written whole after each change."""

from collections.abc import Callable
from pathlib import Path

from vehicle_sim.errors import ConfigurationError, ParameterError
from vehicle_sim.parameters import ParameterStore
from vehicle_sim.parameters.file import MOST_BYTES, as_text, take_text
from vehicle_sim.server.whole_file import write_whole


def load_parameters(path: Path, store: ParameterStore) -> None:
    """Set the parameters that the file at `path` names; one that does not exist yet names none.

    Raises:
        ConfigurationError: The file cannot be read, or a line of it cannot be used.
    """
    try:
        with path.open("rb") as file:
            data = file.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            raise ConfigurationError(f"{path} is longer than {MOST_BYTES} bytes: that is no file of parameters")
        take_text(store, data.decode("utf-8"))
    except FileNotFoundError:
        return
    except UnicodeDecodeError:
        raise ConfigurationError(f"{path} is no text: that is no file of parameters") from None
    except OSError as error:
        raise ConfigurationError(f"{path}: {error.strerror or error}") from error
    except ParameterError as error:
        raise ConfigurationError(f"{path}, {error}") from error


def save_parameters(path: Path, store: ParameterStore) -> None:
    """Write all parameters to `path`: whoever reads it finds the old file or the new one, never half of one.

    Raises:
        ConfigurationError: The file cannot be written.
    """
    try:
        write_whole(path, as_text(store).encode())
    except OSError as error:
        raise ConfigurationError(f"{path}: {error.strerror or error}") from error


def keep_parameters(path: Path, store: ParameterStore, notify: Callable[[str], None]) -> None:
    """Write the file now, and again after each change from now on; a vehicle in the air tells `notify` if it cannot.

    Raises:
        ConfigurationError: The file cannot be written now.
    """

    def save() -> None:
        try:
            save_parameters(path, store)
        except ConfigurationError as error:
            notify(f"{error}; the parameters are not kept")

    save_parameters(path, store)
    store.watch(save)
