"""One emulator process for all clients of a test run (one a worker of xdist), and a module as new for each test."""

from __future__ import annotations

import json
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.peers.emulator_process import EmulatorProcess, emulator


def patch(process: EmulatorProcess, address: int, **change: object) -> dict[str, object]:
    """PATCH /emulator/{address} of the control port; the state afterwards."""
    request = urllib.request.Request(
        f"{process.control}/emulator/{address}",
        json.dumps(change).encode(),
        {"Content-Type": "application/json"},
        method="PATCH",
    )
    with urllib.request.urlopen(request, timeout=10) as answer:
        state: dict[str, object] = json.loads(answer.read())
        return state


@pytest.fixture(scope="session")
def shared_emulator(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EmulatorProcess]:
    """Two modules, addresses 1 and 2, on one line that is a pty and a TCP port."""
    # Its own folder, which is the worker's own too: two workers never share a path.
    pty: Path = tmp_path_factory.mktemp("line") / "module"
    # The noise that flips bits begins with this seed. TMCL's sum of 8 bits lets about one reply in a hundred through
    # whose flips make up for each other, and no client can tell. So seeded, module 1 has none in its first 200.
    given = ("--tcp", "127.0.0.1:0", "--control", "127.0.0.1:0", "--address", "1", "--address", "2", "--seed", "1240")
    with emulator(*given, pty=pty) as process:
        yield process


@pytest.fixture
def modules(shared_emulator: EmulatorProcess) -> EmulatorProcess:
    """The shared process with both modules as they come from the factory, at rest at position 0."""
    for address in (1, 2):
        patch(
            shared_emulator,
            address,
            load_torque_nm=0.0,
            blocked=False,
            stage={"position_fullsteps": 0.0},
            switches={"left": "auto", "right": "auto", "home": "auto"},
            faults={"silence": False, "late_reply_s": 0.0, "bit_error_rate": 0.0, "half_frame_rate": 0.0},
        )
        # Afterwards: a shaft that is turned by hand turns the encoder too.
        patch(shared_emulator, address, power_cycle=True)
    return shared_emulator
