"""The bundled vehicle as a process of its own, which never outlives the flight.

It is told by its standard input: when that closes, for whatever reason, even because this process was killed, the
vehicle ends. It does not share this process's terminal signals, so that Ctrl-C lands it instead of cutting its power.
"""

import contextlib
import queue
import subprocess
import sys
import tempfile
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import IO, Final, Self

from mission.errors import Fault, LinkError, SpecError, reason
from mission.geometry.geodesy import LatLon, place_at_offset
from mission.spec.model import MissionSpec

_START_WITHIN_S: Final = 30.0
_END_WITHIN_S: Final = 3.0
_WORDS: Final = 2000
_BAD_INPUT: Final = 2
"""Its exit code when it cannot use an option, or a file that an option names."""

_HOME_ALTITUDE_M: Final = 100.0
_LISTENING: Final = "udpin:"
_NEW_GROUP: Final = int(getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0))


@dataclass(frozen=True, kw_only=True)
class VehicleOptions:
    """How the bundled vehicle is started; None leaves a choice to the vehicle.

    Attributes:
        speed: Multiples of real time.
        seed: Seed of its noise.
        wind: NORTH,EAST in m/s, where the wind blows to, or SPEED@FROM_DEGREES.
        flavour: The autopilot that it answers like, ``ardupilot`` or ``px4``.
        dynamics: Its equations of motion, ``hover`` or ``quadrotor``.
        faults: File that says what goes wrong with it and when; None for nothing.
        home: Latitude and longitude in degrees, altitude above sea level in metres.
        ground_station: Whether it offers itself to a ground station on this machine's UDP port 14550.
        signing_key: File of the key that it signs with, and asks for.
    """

    speed: float = 20.0
    seed: int | None = None
    wind: str | None = None
    flavour: str | None = None
    dynamics: str | None = None
    faults: str | None = None
    home: tuple[float, float, float] | None = None
    ground_station: bool = True
    signing_key: str | None = None

    def arguments(self) -> list[str]:
        """The vehicle's command line, without the program."""
        arguments = ["--listen", "udpin:127.0.0.1:0", "--announce", "--exit-with-parent", "--quiet", "--lockstep"]
        arguments.append(f"--speed={self.speed:g}")
        choices = {"seed": self.seed, "wind": self.wind, "flavour": self.flavour, "dynamics": self.dynamics}
        for name, value in (choices | {"faults": self.faults}).items():
            if value is not None:
                arguments.append(f"--{name}={value}")
        if self.home is not None:
            latitude, longitude, altitude = self.home
            arguments.append(f"--home={latitude:.9f},{longitude:.9f},{altitude:.3f}")
        if self.signing_key is not None:
            arguments.append(f"--signing-key={self.signing_key}")
        if not self.ground_station:
            arguments.append("--no-ground-station")
        return arguments


def home_for(spec: MissionSpec) -> tuple[float, float, float] | None:
    """Where to put the vehicle so that it stands at the mission's start; None for a mission without a place."""
    if spec.origin is None:
        return None
    east_m, north_m = spec.start.position_m
    place = place_at_offset(LatLon(spec.origin.latitude_deg, spec.origin.longitude_deg), east_m, north_m)
    return place.latitude_deg, place.longitude_deg, _HOME_ALTITUDE_M


class BundledVehicle:
    """The running vehicle, in lock-step with whoever flies it; a context that ends it whatever happens.

    Attributes:
        address: Where to call it.
    """

    def __init__(self, options: VehicleOptions, command: Sequence[str] = (sys.executable, "-m", "vehicle_sim")) -> None:
        """Start it and wait until it listens.

        Raises:
            LinkError: It did not start; with what it said.
        """
        try:
            self._words = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the vehicle
        except OSError as error:
            raise LinkError(
                "the bundled vehicle cannot be started: no folder for temporary files can be written to; make room on "
                "the disk, or name another folder in TMPDIR"
            ) from error
        self._lines: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._process: subprocess.Popen[bytes] | None = None
        self.address = ""
        try:
            self._process = process = subprocess.Popen(  # noqa: S603 - this project's own program
                [*command, *options.arguments()],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._words,
                start_new_session=True,
                creationflags=_NEW_GROUP,
            )
            threading.Thread(target=self._read, args=(process.stdout,), daemon=True).start()
            self.address = self._await_address()
        except OSError as error:
            self.close()
            raise LinkError(f"the bundled vehicle cannot be started: {reason(error)}") from error
        except BaseException:  # also Ctrl-C: nothing may stay behind
            self.close()
            raise

    def failure(self) -> str:
        """Why it is no longer there, in plain words; empty while it runs."""
        code = None if self._process is None else self._process.poll()
        return "" if code is None else f"the bundled vehicle has ended ({_ending(code)}){self._said()}"

    @property
    def process_id(self) -> int:
        """The number of its process; 0 where there is none."""
        return 0 if self._process is None else self._process.pid

    def close(self) -> None:
        """End it: by its closed input, else by a signal, else by force."""
        process = self._process
        if process is not None:
            if process.stdin is not None:
                with contextlib.suppress(OSError):
                    process.stdin.close()
            for end in (process.poll, process.terminate, process.kill):
                end()
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(_END_WITHIN_S)
                    break
        self._words.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _read(self, output: IO[bytes]) -> None:
        """Read to the end, so that the vehicle never waits for a reader; an empty line says that it has ended."""
        with output:
            for line in output:
                self._lines.put(line.decode("utf-8", "replace").strip() or " ")
        self._lines.put("")

    def _await_address(self) -> str:
        try:
            while line := self._lines.get(timeout=_START_WITHIN_S):
                word, _, addresses = line.partition(" ")
                listening = [address for address in addresses.split() if address.startswith(_LISTENING)]
                if word == "READY" and listening:
                    return "udpout:" + listening[0].removeprefix(_LISTENING)
        except queue.Empty:
            raise LinkError(f"the bundled vehicle was not ready within {_START_WITHIN_S:.0f} s{self._said()}") from None
        code = None if self._process is None else self._process.wait(_END_WITHIN_S)
        if code == _BAD_INPUT:
            what = self._said() or " what it was asked"
            raise SpecError((Fault(0, 0, "", f"the bundled vehicle refuses{what}", "mend that, and fly again"),))
        raise LinkError(f"the bundled vehicle did not start{self._said()}")

    def _said(self) -> str:
        """The end of what it wrote to its error output."""
        if self._words.closed:
            return ""
        size = self._words.seek(0, 2)
        self._words.seek(max(size - _WORDS, 0))
        words = self._words.read().decode("utf-8", "replace").strip()
        return f"; it said: {words}" if words else ""


def _ending(code: int) -> str:
    return f"signal {-code}" if code < 0 else f"exit code {code}"
