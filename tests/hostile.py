"""Requests of people who should not get in, as the bytes that they send: foreign pages, guessers, readers of files.

`attacks` makes as many as are wanted, the same ones for the same seed. `send` sends one over a connection of its own,
`Finding` says what came of it. Which answers are well is part of each attack: a refusal, or the end of the connection;
that nothing changed and nothing leaked is for the caller to see in the server afterwards.
"""

from __future__ import annotations

import json
import random
import socket
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal
from urllib.parse import quote

CANARY = "canary-7f3a-outside-of-every-folder"
"""Text of a file beside the data directory, which nobody may get to read."""
LEAKS = (CANARY.encode(), b"root:x:0:", b"BEGIN PRIVATE KEY")
BODY_LIMIT_BYTES = 1 << 20
PATIENCE_S = 20.0

Door = Literal["open", "token"]
"""Whom it is for: a server on loopback without a token, or one that asks for a token."""

MOVING = (
    ("POST", "/api/v1/devices/bench/axes/0/move", {"target": 51200}),
    ("POST", "/api/v1/devices/bench/axes/0/rotate", {"velocity": 1000}),
    ("PUT", "/api/v1/devices/bench/registers/v_max?axis=0", {"value": 7}),
    ("PATCH", "/api/v1/devices/bench", {"name": "stolen"}),
    ("DELETE", "/api/v1/devices/bench", None),
    ("POST", "/api/v1/devices", {"name": "mine", "model": "tmc428", "link": {"kind": "emulator"}}),
    ("POST", "/api/v1/devices/bench/exchange", {"frame": "00000001"}),
    ("POST", "/api/v1/recordings", {"device": "bench", "channels": ["position.0"]}),
    ("PATCH", "/api/v1/devices/bench/emulator", {"time_scale": 0}),
)
"""What would change the demo bench if it came through."""
READING = ("/api/v1/devices", "/api/v1/devices/bench/registers", "/openapi.json", "/", "/api/v1/recordings")


@dataclass(frozen=True)
class Attack:
    """`request` is sent as it is; well are the statuses in `well`, and 0: the connection ended without an answer."""

    kind: str
    door: Door
    request: bytes
    well: frozenset[int]
    may_serve: bool = False
    """An answer 200 is well too, as long as nothing leaks in it: a strange way to ask for what everybody may see."""


@dataclass(frozen=True)
class Finding:
    """What came of an attack; `wrong` is empty where all is well."""

    attack: Attack
    status: int
    wrong: str


REFUSED = frozenset({0, 400, 401, 403, 404, 405, 413, 414, 421, 422, 429, 431})


def attacks(count: int, authority: str, seed: int = 6) -> Iterator[Attack]:
    """`count` attacks on a server that is reached as `authority` (host:port), all kinds in turn."""
    chance = random.Random(seed)
    kinds = (_cross_origin, _cross_socket, _rebinding, _no_token, _wrong_token, _traversal, _oversized, _malformed)
    for number in range(count):
        yield kinds[number % len(kinds)](chance, authority)


def send(attack: Attack, address: tuple[str, int]) -> Finding:
    """Send it, and judge the answer."""
    answer = b""
    try:
        with socket.create_connection(address, PATIENCE_S) as connection:
            try:
                connection.sendall(attack.request)
                connection.shutdown(socket.SHUT_WR)
            except (BrokenPipeError, ConnectionResetError):
                pass  # it has heard enough; what it said is still to be read
            while chunk := connection.recv(1 << 16):
                answer += chunk
    except (ConnectionResetError, BrokenPipeError):
        pass
    except TimeoutError:
        return Finding(attack, 0, "no answer, and the connection stays open")
    first = answer.split(b"\r\n", 1)[0].split(b" ")
    status = int(first[1]) if len(first) > 1 and first[1].isdigit() else 0
    leaked = next((leak for leak in LEAKS if leak in answer), None)
    if leaked is not None:
        return Finding(attack, status, f"leaked {leaked!r}")
    well = status in attack.well or (attack.may_serve and status == 200)
    return Finding(attack, status, "" if well else f"answered {status}: {answer[-300:]!r}")


# --- the kinds -----------------------------------------------------------------------------------


def _cross_origin(chance: random.Random, authority: str) -> Attack:
    """A page elsewhere posts to this machine, with whatever of a browser's headers it has."""
    method, path, body = chance.choice(MOVING)
    origin: tuple[str, ...] = chance.choice(
        (
            (f"Origin: https://{_name(chance)}.example",),
            ("Origin: null",),
            (f"Origin: http://{authority}.{_name(chance)}.example", "Sec-Fetch-Site: cross-site"),
            (f"Origin: http://{authority.rpartition(':')[0]}:{chance.randrange(1, 1024)}",),
            ("Sec-Fetch-Site: cross-site",),
            ("Sec-Fetch-Site: same-site",),
            (f"Origin: file://{authority}",),
            (f"Origin: http://user@{_name(chance)}.example/{authority}",),
        )
    )
    kind = chance.choice(("application/json", "text/plain", "application/x-www-form-urlencoded"))
    return Attack("cross origin", "open", _request(method, path, authority, body, *origin, kind=kind), frozenset({403}))


def _cross_socket(chance: random.Random, authority: str) -> Attack:
    path = chance.choice(("/api/v1/devices/bench/telemetry?channels=position.0", "/twin/view/", "/api/v1/lease"))
    request = _request(
        "GET",
        path,
        authority,
        None,
        f"Origin: https://{_name(chance)}.example",
        "Upgrade: websocket",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        connection="Upgrade",
    )
    return Attack("foreign socket", "open", request, frozenset({403}))


def _rebinding(chance: random.Random, authority: str) -> Attack:
    """A foreign name that points at this machine: same-origin for the browser, but it bears the name."""
    port = authority.rpartition(":")[2]
    name = f"{_name(chance)}.{chance.choice(('example', 'attacker.com', 'localhost.evil.org', '127.0.0.1.nip.io'))}"
    host = chance.choice((name, f"{name}:{port}", name.upper(), f"{name}."))
    if chance.random() < 0.5:
        request = _request("GET", chance.choice(READING), host, None)
    else:
        method, path, body = chance.choice(MOVING)
        request = _request(method, path, host, body, f"Origin: http://{host}", "Sec-Fetch-Site: same-origin")
    return Attack("rebinding", "open", request, frozenset({403}))


def _no_token(chance: random.Random, authority: str) -> Attack:
    cookie = chance.choice(
        (
            "",
            f"Cookie: stepscope_{authority.rpartition(':')[2]}={_name(chance)}",
            "Cookie: \x7f=;;;=",
            "Authorization: Basic YTpi",
        )
    )
    method, path, body = chance.choice((*MOVING, *(("GET", path, None) for path in READING)))
    request = _request(method, path, authority, body, *((cookie,) if cookie else ()))
    return Attack("no token", "token", request, frozenset({400, 401, 429}))


def _wrong_token(chance: random.Random, authority: str) -> Attack:
    method, path, body = chance.choice((*MOVING, *(("GET", path, None) for path in READING)))
    guess = chance.choice(
        (_name(chance) * 3, "", "%00", "a" * chance.randrange(1, 3000), "\xfc\xdf\xfe", "' OR 1=1 --")
    )
    if chance.random() < 0.3:
        request = _request("GET", f"/?token={quote(guess)}", authority, None, "Accept: text/html")
    else:
        request = _request(method, path, authority, body, f"Authorization: Bearer {guess}")
    return Attack("wrong token", "token", request, frozenset({400, 401, 429}))


def _traversal(chance: random.Random, authority: str) -> Attack:
    up = chance.choice(
        ("../", "..%2f", "%2e%2e/", "%2e%2e%2f", "..\\", "..%5c", "....//", "%252e%252e%252f", "..%c0%af", "..;/")
    )
    target = chance.choice(
        ("etc/passwd", "canary.txt", "stepscope.sqlite3", "proc/self/environ", "%00etc/passwd", "key.pem")
    )
    root = chance.choice(
        (
            "/",
            "/assets/",
            "/api/v1/recordings/",
            "/api/v1/devices/",
            "/api/v1/catalog/",
            "/api/v1/profiles/",
            "/twin/view/",
            "//",
            "/%00/",
        )
    )
    path = root + up * chance.randrange(1, 12) + target + chance.choice(("", "?format=csv", "%00.html", "/plot"))
    request = _request(chance.choice(("GET", "GET", "HEAD")), path, authority, None)
    # What is no file and bears no dot is a route of the page's own: it gets our page.
    return Attack("path traversal", "open", request, REFUSED | {308, 307, 409}, may_serve=True)


def _oversized(chance: random.Random, authority: str) -> Attack:
    method, path, _ = chance.choice([entry for entry in MOVING if entry[2] is not None])
    how = chance.randrange(6)
    large = BODY_LIMIT_BYTES + chance.randrange(1, 4096)
    if how == 0:  # declared, and hardly sent
        request = _head(method, path, authority, f"Content-Length: {large}") + b"{" * 1024
    elif how == 1:
        request = _head(method, path, authority, f"Content-Length: {10 ** chance.randrange(10, 30)}") + b"{"
    elif how == 2:  # without a length
        piece = b"%x\r\n" % 65536 + b" " * 65536 + b"\r\n"
        request = _head(method, path, authority, "Transfer-Encoding: chunked") + piece * 17 + b"0\r\n\r\n"
    elif how == 3:
        request = _request("GET", "/api/v1/devices?" + "a" * 70_000, authority, None)
    elif how == 4:
        request = _request("GET", "/api/v1/devices", authority, None, "X-Long: " + "a" * 70_000)
    else:
        request = _request(
            "POST", "/api/v1/calc/microstep-table", authority, {"chip": "tmc428", "sigma": 0, "pad": "a" * 70_000}
        )
    return Attack("oversized", "open", request, REFUSED, may_serve=request.startswith(b"GET"))


def _malformed(chance: random.Random, authority: str) -> Attack:
    method, path, body = chance.choice([entry for entry in MOVING if entry[2] is not None])
    text = json.dumps(body).encode()
    junk: tuple[Callable[[], bytes], ...] = (
        lambda: text[: chance.randrange(1, len(text))],
        lambda: b"[" * 20_000,
        lambda: b'{"a":' * 20_000,
        lambda: b"\xff\xfe" + chance.randbytes(chance.randrange(1, 200)),
        lambda: b'{"target": NaN, "velocity": Infinity, "value": 1e999, "name": 1, "frame": 5, "device": 1}',
        lambda: (
            b'{"target": [], "velocity": {}, "value": "x", "name": [], "frame": "zz", "device": {}, "time_scale": []}'
        ),
        lambda: b'{"target": 1' + b"0" * 5000 + b', "velocity": 1' + b"0" * 5000 + b"}",
        lambda: b"null",
        lambda: b'"' + b"\\u0000" * 1000 + b'"',
    )
    how = chance.randrange(4)
    if how < 3:
        said = chance.choice(junk)()
        request = _head(method, path, authority, f"Content-Length: {len(said)}") + said
    else:
        request = chance.choice(
            (
                b"GET\r\n\r\n",
                b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + chance.randbytes(64),
                b"GET / HTTP/9.9\r\nHost: " + authority.encode() + b"\r\n\r\n",
                b"G\x00T / HTTP/1.1\r\n\r\n",
                b"POST /api/v1/stop HTTP/1.1\r\nHost: a\r\nHost: "
                + authority.encode()
                + b"\r\nContent-Length: -5\r\n\r\n",
                b"GET http://evil.example/ HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n",
                _head(method, path, authority, "Content-Length: 5", "Transfer-Encoding: chunked") + b"zz\r\n",
                _head(method, path, authority, "Transfer-Encoding: chunked") + b"-1\r\n\r\n",
                chance.randbytes(300),
            )
        )
    return Attack("malformed", "open", request, REFUSED)


# --- bytes ---------------------------------------------------------------------------------------


def _head(method: str, path: str, host: str, *headers: str, connection: str = "close") -> bytes:
    lines = (f"{method} {path} HTTP/1.1", f"Host: {host}", f"Connection: {connection}", *headers)
    if method not in ("GET", "HEAD") and not any(line.startswith("Content-Type") for line in headers):
        lines = (*lines, "Content-Type: application/json")
    return "\r\n".join(lines).encode("latin-1") + b"\r\n\r\n"


def _request(
    method: str,
    path: str,
    host: str,
    body: object,
    *headers: str,
    kind: str = "application/json",
    connection: str = "close",
) -> bytes:
    said = b"" if body is None else json.dumps(body).encode()
    lengths = (f"Content-Length: {len(said)}", f"Content-Type: {kind}") if said else ()
    return _head(method, path, host, *headers, *lengths, connection=connection) + said


def _name(chance: random.Random) -> str:
    return "".join(chance.choices("abcdefghijklmnopqrstuvwxyz", k=chance.randrange(3, 12)))
