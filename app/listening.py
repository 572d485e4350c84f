"""Bound sockets and the names that people call them by."""

from __future__ import annotations

import errno
import os
import socket


class CannotListen(OSError):
    """The address cannot be had; the text says why and what to do."""


PORT_FLAG = "--port"


def listen(host: str, port: int, flag: str = PORT_FLAG) -> socket.socket:
    """A bound socket; port 0 picks a free one. `flag` : which says where to listen. Raises CannotListen."""
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, kind, protocol)
        try:
            if os.name == "posix":  # elsewhere it would let two servers have the same port
                listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind(address)
        except OSError:
            listener.close()
            raise
    except OSError as error:
        raise CannotListen(why(error, host, port, flag)) from error
    listener.setblocking(False)
    return listener


def why(error: OSError, host: str, port: int, flag: str = PORT_FLAG) -> str:
    """Why that address cannot be had, and what to do."""
    if error.errno == errno.EADDRINUSE:
        other = _said(port + 1, flag)
        return f"port {port} of {host} is taken; is stepscope running already? Another one: {other}; 0 is any free one"
    if error.errno == errno.EACCES:
        return f"port {port} needs more rights; use one above 1023, e.g. {_said(8000, flag)}"
    return f"cannot listen on {host}:{port}: {error.strerror or error}"


def _said(port: int, flag: str) -> str:
    """How a user asks for a port: the server is started by make, too."""
    return f"{flag} {port}, or make run PORT={port}" if flag == PORT_FLAG else f"{flag} HOST:{port}"


def url_of(host: str, port: int, scheme: str = "http") -> str:
    """Where a browser of this machine finds what listens there."""
    shown = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host)
    return f"{scheme}://[{shown}]:{port}" if ":" in shown else f"{scheme}://{shown}:{port}"


def host_and_port(flag: str, address: str) -> tuple[str, int]:
    """HOST:PORT, or [V6]:PORT, taken apart. Raises ValueError, which names `flag`."""
    host, separator, port_text = address.rpartition(":")
    if not separator or not port_text.isdecimal() or int(port_text) > 65_535:
        raise ValueError(f"{flag} is HOST:PORT, e.g. 127.0.0.1:4280, not {address!r}")
    return host.strip("[]"), int(port_text)
