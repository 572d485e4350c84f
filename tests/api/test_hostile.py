"""A short run of the attacks of `make bench`, on real servers; and that their judge would see somebody who got in."""

from __future__ import annotations

import socket
import threading
from pathlib import Path

import pytest

from tests.bench.hostile import attacked
from tests.hostile import CANARY, Attack, attacks, send


def test_nobody_gets_in_and_nothing_falls_over(tmp_path: Path) -> None:
    (tmp_path / "canary.txt").write_text(CANARY)
    findings, troubles = attacked(tmp_path, 240)
    assert len({finding.attack.kind for finding in findings}) == 8
    assert [finding for finding in findings if finding.wrong] == []
    assert troubles == []


def test_the_same_seed_makes_the_same_attacks() -> None:
    assert list(attacks(80, "127.0.0.1:1")) == list(attacks(80, "127.0.0.1:1"))
    assert len({attack.request for attack in attacks(800, "127.0.0.1:1")}) > 500


@pytest.mark.parametrize(
    ("answer", "wrong"),
    [
        (b"HTTP/1.1 403 Forbidden\r\n\r\n", ""),
        (b"", ""),
        (b"HTTP/1.1 200 OK\r\n\r\n{}", "answered 200"),
        (b"HTTP/1.1 500 Internal Server Error\r\n\r\n", "answered 500"),
        (b"HTTP/1.1 403 Forbidden\r\n\r\n" + CANARY.encode(), "leaked"),
    ],
)
def test_the_judge_sees_who_got_in(answer: bytes, wrong: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            with server.accept()[0] as connection:
                while connection.recv(1 << 16):
                    pass
                connection.sendall(answer)

        threading.Thread(target=serve).start()
        attack = Attack("any", "open", b"GET / HTTP/1.1\r\n\r\n", frozenset({0, 403}))
        finding = send(attack, server.getsockname())
    assert finding.wrong.startswith(wrong) if wrong else not finding.wrong
