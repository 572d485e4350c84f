"""TMC5xxx chips on the single wire of a UART: `/dev/ttyUSB0`, `/dev/serial0`, `socket://host:port`.

Several chips share a line by their node addresses; a TMC5062 has none and is alone on its line. The line is that of
TMCL modules (`serial_line`): one thread, one arbiter, one budget for all ports of the same name.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from ..clock import Clock
from ..errors import LinkDown
from .datagram_uart import WRITE_BIT, UartForm
from .line_session import LineSession
from .line_thread import Job
from .serial_address import device_of
from .serial_line import SOCKET, Line, LinePort, open_device, shared_line
from .streams import Stream
from .uart_session import Echo, UartSession

BAUD = 115_200
"""The chips measure the baud rate themselves, from 9000 baud up to a sixteenth of their clock."""
DELAY_BYTES = 1
"""What a chip waits before it answers: eight bit times, unless SENDDELAY says more."""


class UartLine(Line):
    """A line of chips. What its ports say of echo and datagrams holds for all who have it open."""

    @property
    def echo(self) -> Echo | None:
        """What the ports that have it open say of an echo; None where it is closed."""
        return next((port.echo for port in self.users if isinstance(port, UartPort)), None)

    def put(self, port: LinePort, job: Job) -> None:
        """Raises LinkDown where others have the line open otherwise."""
        for other in self.users:
            if isinstance(other, UartPort) and isinstance(port, UartPort):
                if other.echo != port.echo:
                    raise LinkDown(port.name, f"the line is open with echo {other.echo} for {other.name}; use the same")
                if (other.form.node is None) != (port.form.node is None):
                    raise LinkDown(port.name, f"the line is open for {other.name}; chips without a node need their own")
        super().put(port, job)

    def session(self, stream: Stream, byte_s: float, tell_event: Callable[[bytes], None]) -> LineSession:
        del tell_event  # chips speak only when they are asked
        port = next(user for user in self.users if isinstance(user, UartPort))
        return UartSession(self.name, stream, self.incidents, port.form, port.echo, byte_s)


class UartPort(LinePort):
    """`BatchPort` of one chip on a `UartLine`: datagrams of `form` out, answers back.

    The answer to a write is a reading of IFCNT that has counted it.
    """

    def __init__(
        self,
        line: UartLine,
        form: UartForm,
        *,
        baud: int | None,
        echo: Echo = "auto",
        timeout_s: float | None = None,
        clock: Clock | None = None,
    ) -> None:
        self.form = form
        self._reads = frozenset(form.read(register) for register in range(WRITE_BIT))
        """Every datagram that reads: looked up sooner than checked."""
        self.echo: Echo = echo
        self.call_bytes = form.read_bytes + DELAY_BYTES + form.reply_bytes
        super().__init__(line, address=form.node or 0, baud=baud, timeout_s=timeout_s, clock=clock)

    @property
    def name(self) -> str:
        return self.line.name if self.form.node is None else f"{self.line.name}, node {self.form.node}"

    def check(self, frames: Sequence[bytes]) -> None:
        """Raises ValueError for a frame that is no datagram to this chip."""
        for frame in frames:
            if frame not in self._reads:
                self.form.check(frame)


def uart_line_of(url: str) -> UartLine:
    """The line behind a device name or a URL of pyserial."""
    name = f"uart {url}"
    return shared_line(name, lambda: UartLine(name, partial(open_device, name, url), device_of(url)))


def uart_port(
    url: str,
    form: UartForm,
    *,
    baud: int = BAUD,
    echo: Echo = "auto",
    timeout_s: float | None = None,
    clock: Clock | None = None,
) -> UartPort:
    """A chip on the line behind a device name or a URL of pyserial; `socket://` has no baud rate.

    `echo` says whether the line gives back what is sent to it: "auto" finds out. `timeout_s` as in `whole_timeout_s`.
    """
    return UartPort(
        uart_line_of(url),
        form,
        baud=None if url.startswith(SOCKET) else baud,
        echo=echo,
        timeout_s=timeout_s,
        clock=clock,
    )
