"""`stepscope emulate landungsbruecke` for the tests of a session, as new for each of them."""

from __future__ import annotations

import json
import urllib.request
from collections.abc import Iterator

import pytest

from tests.peers.emulator_process import EmulatorProcess, emulator

AS_NEW = {
    "power_cycle": True,
    "faults": {"silence": False, "late_reply_s": 0.0, "bit_error_rate": 0.0, "half_frame_rate": 0.0},
    "chip": {"time_scale": 1.0, "stage": {"position_fullsteps": 0.0}, "faults": {"silence": False}},
}


def patch_board(process: EmulatorProcess, change: dict[str, object], path: str = "emulator") -> dict[str, object]:
    """PATCH of the control port; the state afterwards."""
    request = urllib.request.Request(
        f"{process.control}/{path}", json.dumps(change).encode(), {"Content-Type": "application/json"}, method="PATCH"
    )
    with urllib.request.urlopen(request, timeout=30) as answer:
        state: dict[str, object] = json.loads(answer.read())
        return state


@pytest.fixture(scope="session")
def shared_board(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EmulatorProcess]:
    """A board on a pty and on a TCP port."""
    flags = ("--chip", "tmc4361", "--tcp", "127.0.0.1:0", "--control", "127.0.0.1:0")
    with emulator(*flags, pty=tmp_path_factory.mktemp("board") / "board", model="landungsbruecke") as process:
        yield process


@pytest.fixture
def board(shared_board: EmulatorProcess) -> EmulatorProcess:
    """The shared board as after power-on, at rest at position 0."""
    patch_board(shared_board, AS_NEW)
    return shared_board
