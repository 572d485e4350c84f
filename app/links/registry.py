"""Kinds of links by name. The composition root says which there are; nobody else imports them all."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import cast, get_args

from ..clock import Clock
from ..errors import OutOfRange, UnknownThing, UsageError
from ..registers import catalog
from ..registers.wires import BOARD, Wire
from . import datagram_uart, evaluation_board, spidev_port, uart_line
from .can_line import can_port
from .port import FramePort
from .serial_address import port_url
from .serial_line import ADDRESS, BAUD, SOCKET, serial_port
from .spi_datagram import chained, frame_bytes_of
from .tcp import TIMEOUT_S, TcpPort
from .uart_session import Echo

Link = Mapping[str, object]
"""What a connection is made of: `kind` and the options of that kind."""

PortFactory = Callable[[str, Link, Clock], FramePort]
"""(model, link, clock) to a port, not yet open. Raises UsageError for options that cannot be."""

SPEED_HZ_MAX = 16_000_000
"""Half of the fastest clock that any chip of 40-bit datagrams may have (DS-TMC4361 5.3)."""
CLOCKS_A_BIT_32 = 8
"""Of a chip with 32-bit datagrams: its answer is valid four clocks after the falling edge (DS-TMC428 6.2)."""
UART_BAUD_MIN = 9000
"""Slower than this no chip can measure (TMC5160A data sheet 1.14, 5.1.1)."""


def speaks_tmcl(model: str) -> bool:
    """Whether it is a module: nine-byte frames, several on one line by address."""
    return catalog.find_model(model).kind == "module"


def tcp_factory(model: str, link: Link, clock: Clock) -> FramePort:
    """`{"kind": "tcp", "host", "port", "timeout_s"?}`, and `"address"?` for a TMCL module behind a gateway."""
    _only_over("tcp", model)
    tmcl = speaks_tmcl(model)
    _only(link, "host", "port", "timeout_s", *(["address"] if tmcl else []))
    host = _text(link, "host")
    port = _whole(link, "port", None, 1, 65535)
    if not tmcl:
        return TcpPort(
            host,
            port,
            timeout_s=_timeout_s(link) or TIMEOUT_S,
            clock=clock,
            frame_bytes=frame_bytes_of(model),
            pipelined=chained(model),
        )
    bracketed = f"[{host}]" if ":" in host else host
    return serial_port(
        port_url(f"{SOCKET}{bracketed}:{port}"), address=_address(link), timeout_s=_timeout_s(link), clock=clock
    )


def spidev_factory(model: str, link: Link, clock: Clock) -> FramePort:
    """`{"kind": "spidev", "bus", "device", "speed_hz"?, "mode"?}`: a chip select of this machine."""
    _only_over("spidev", model)
    _only(link, "bus", "device", "speed_hz", "mode")
    known = catalog.find_model(model)
    slow = known.datagram_bits == 32 and known.spi is None
    fastest_hz = int(known.clock_hz_max / CLOCKS_A_BIT_32) if slow else SPEED_HZ_MAX
    return spidev_port.SpidevPort(
        _whole(link, "bus", None, 0, 255),
        _whole(link, "device", None, 0, 255),
        frame_bytes=frame_bytes_of(model),
        speed_hz=_whole(link, "speed_hz", spidev_port.SPEED_HZ, 10_000, fastest_hz),
        mode=_whole(link, "mode", spidev_port.MODE, 0, 3),
        pipelined=chained(model),
        clock=clock,
    )


def uart_factory(model: str, link: Link, clock: Clock) -> FramePort:
    """`{"kind": "uart", "port", "baud"?, "node"?, "echo"?, "timeout_s"?}`; `port` is a device name or a URL.

    A chip without a node address has no option `node`.
    """
    _only_over("uart", model)
    if "node" in link and datagram_uart.kind_of(model) == "plain":
        raise UsageError(f"a {model} has no node address, and is alone on its line")
    _only(link, "port", "baud", "node", "echo", "timeout_s")
    echo = link.get("echo", "auto")
    if echo not in get_args(Echo):
        raise UsageError(f"echo is {', '.join(get_args(Echo))}, not {echo!r}")
    return uart_line.uart_port(
        port_url(_text(link, "port")),
        datagram_uart.form_of(model, _whole(link, "node", 0, 0, datagram_uart.node_max(model))),
        baud=_whole(link, "baud", uart_line.BAUD, UART_BAUD_MIN, 4_000_000),
        echo=cast("Echo", echo),
        timeout_s=_timeout_s(link),
        clock=clock,
    )


def board_factory(model: str, link: Link, clock: Clock) -> FramePort:
    """`{"kind": "landungsbruecke", "port", "baud"?, "motor"?, "timeout_s"?}`; `port` is a device name or a URL.

    `motor` is the axis of the chip on the board: `register_access.access_of` wants it.
    """
    _only_over(BOARD, model)
    _only(link, "port", "baud", "motor", "timeout_s")
    _whole(link, "motor", 0, 0, 15)
    return evaluation_board.board_port(
        port_url(_text(link, "port")),
        baud=_whole(link, "baud", evaluation_board.BAUD, 300, 4_000_000),
        address=catalog.find_model(model).slot.module,
        timeout_s=_timeout_s(link),
        clock=clock,
    )


def serial_factory(model: str, link: Link, clock: Clock) -> FramePort:
    """`{"kind": "serial", "port", "baud"?, "address"?, "timeout_s"?}`; `port` is a device name or a URL."""
    _only_over("serial", model)
    _only(link, "port", "baud", "address", "timeout_s")
    baud = _whole(link, "baud", BAUD, 300, 4_000_000)
    return serial_port(
        port_url(_text(link, "port")), baud=baud, address=_address(link), timeout_s=_timeout_s(link), clock=clock
    )


def can_factory(model: str, link: Link, clock: Clock) -> FramePort:
    """`{"kind": "can", "interface", "channel", "bitrate"?, "send_id"?, "receive_id"?, "timeout_s"?}`."""
    _only_over("can", model)
    _only(link, "interface", "channel", "bitrate", "send_id", "receive_id", "timeout_s")
    send_id = _whole(link, "send_id", 1, 0, 0x7FF)
    receive_id = _whole(link, "receive_id", 2, 0, 0x7FF)
    if send_id == receive_id:
        raise UsageError(f"send_id and receive_id are both {send_id}: then nobody can tell questions from answers")
    return can_port(
        _text(link, "interface"),
        _text(link, "channel"),
        bitrate=_whole(link, "bitrate", 1_000_000, 10_000, 1_000_000),
        send_id=send_id,
        receive_id=receive_id,
        timeout_s=_timeout_s(link),
        clock=clock,
    )


def open_port(kinds: Mapping[str, PortFactory], model: str, link: Link, clock: Clock) -> FramePort:
    """The port that `link` describes. Raises UnknownThing for a kind that is not in `kinds`."""
    kind = link.get("kind", "")
    factory = kinds.get(kind) if isinstance(kind, str) else None
    if factory is None:
        raise UnknownThing("kind of link", str(kind), sorted(kinds))
    return factory(model, link, clock)


# --- options ----------------------------------------------------------------------------------


def _only_over(kind: Wire, model: str) -> None:
    if kind not in catalog.find_model(model).wires:
        having = sorted(known.name for known in catalog.MODELS.values() if kind in known.wires)
        raise UsageError(f"a {model} has no {kind} link; {', '.join(having)} has")


def _only(link: Link, *options: str) -> None:
    unknown = set(link) - {"kind", *options}
    if unknown:
        raise UnknownThing(f"option of a {link.get('kind', '')} link", min(unknown), list(options))


def _text(link: Link, option: str) -> str:
    text = link.get(option)
    if not isinstance(text, str) or not text.strip():
        raise UsageError(f"a {link.get('kind', '')} link needs a {option}")
    return text.strip()


def _whole(link: Link, option: str, default: int | None, minimum: int, maximum: int) -> int:
    value = link.get(option, default)
    if isinstance(value, bool) or not isinstance(value, int) or not minimum <= value <= maximum:
        raise OutOfRange(option, value, minimum, maximum)
    return value


def _address(link: Link) -> int:
    return _whole(link, "address", ADDRESS, 1, 255)


def _timeout_s(link: Link) -> float | None:
    """None where the option is not there."""
    value = link.get("timeout_s")
    if "timeout_s" not in link:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.001 <= value <= 60:
        raise OutOfRange("timeout_s", value, 0.001, 60)
    return float(value)
