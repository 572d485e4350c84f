"""Kinds of links by name. The composition root says which there are; nobody else imports them all."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import cast

from app.clock import Clock
from app.links.errors import OutOfRange, UnknownThing, UsageError
from app.links.port import FramePort
from app.links.tcp import TIMEOUT_S, TcpPort

Link = Mapping[str, object]
"""What a connection is made of: `kind` and the options of that kind."""

PortFactory = Callable[[str, Link, Clock], FramePort]
"""(model, link, clock) to a port, not yet open. Raises UsageError for options that cannot be."""


def tcp_factory(model: str, link: Link, clock: Clock) -> FramePort:
    """`{"kind": "tcp", "host", "port", "timeout_s"?}`; the same for every model: its frames go as they are."""
    unknown = set(link) - {"kind", "host", "port", "timeout_s"}
    if unknown:
        raise UnknownThing("option of a tcp link", min(unknown), ["host", "port", "timeout_s"])
    host, port, timeout_s = link.get("host"), link.get("port"), link.get("timeout_s", TIMEOUT_S)
    if not isinstance(host, str) or not host.strip():
        raise UsageError("a tcp link needs a host")
    if isinstance(port, bool) or not isinstance(port, int) or not 1 <= port <= 65535:
        raise OutOfRange("port", port, 1, 65535)
    if isinstance(timeout_s, bool) or not isinstance(timeout_s, int | float) or not 0.001 <= timeout_s <= 60:
        raise OutOfRange("timeout_s", timeout_s, 0.001, 60)
    return TcpPort(host.strip(), port, timeout_s=float(timeout_s), clock=clock)


def open_port(kinds: Mapping[str, PortFactory], model: str, link: Link, clock: Clock) -> FramePort:
    """The port that `link` describes. Raises UnknownThing for a kind that is not in `kinds`."""
    kind = cast("str", link.get("kind", ""))
    factory = kinds.get(kind)
    if factory is None:
        raise UnknownThing("kind of link", str(kind), sorted(kinds))
    return factory(model, link, clock)
