"""What is told of an address that cannot be listened on: a way out that the user's own command has."""

from __future__ import annotations

import errno
import socket

import pytest

from app.listening import CannotListen, listen, why


@pytest.mark.parametrize(
    ("flags", "ways"),
    [
        ((), ("--port {other}", "make run PORT={other}")),
        (("--tcp",), ("--tcp HOST:{other}",)),
    ],
)
def test_a_port_that_is_taken_is_told_with_another_one(flags: tuple[str, ...], ways: tuple[str, ...]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(CannotListen, match=f"port {port} of 127.0.0.1 is taken") as told:
            listen("127.0.0.1", port, *flags)
    for way in ways:
        assert way.format(other=port + 1) in str(told.value)
    assert ("make" in str(told.value)) == (not flags)


def test_a_port_that_needs_more_rights_is_told_with_one_that_needs_none() -> None:
    told = why(OSError(errno.EACCES, ""), "127.0.0.1", 80)
    assert "--port 8000, or make run PORT=8000" in told
