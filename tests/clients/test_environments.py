"""Where a client cannot be had, its tests are skipped in pip's words, and asked for once."""

from pathlib import Path

import pytest

from tests.clients import environments
from tests.clients.environments import NoWheelError, environment


def test_without_a_wheel_there_is_a_reason(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.delenv("PIP_FIND_LINKS", raising=False)
    with pytest.raises(NoWheelError, match="No matching distribution found for mavsdk"):
        environment(4, tmp_path, tmp_path)
    monkeypatch.setattr(environments, "_make", lambda *_: pytest.fail("asked for twice"))
    with pytest.raises(NoWheelError, match="No matching distribution found for mavsdk"):
        environment(4, tmp_path, tmp_path)
