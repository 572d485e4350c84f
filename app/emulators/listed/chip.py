"""A plain emulated chip: every register of its table holds what was written, and ramp generators move.

Nothing here knows what a register does, but for those of a ramp generator, told by name. Their numbers are taken
for counts, counts/s and counts/s^2. After power-on a register holds what the table says, and 0 where it says nothing;
speed and acceleration of a ramp generator hold something with which it can move.
"""

from __future__ import annotations

from collections.abc import Mapping

from ...clock import Clock
from ...links import datagram40, spi_datagram
from ...links.datagram_uart import IFCNT, SYNC, WRITE_BIT, UartForm, crc8
from ...registers.entry import Model
from ...registers.listed.ramp import BACKWARD, FORWARD, POSITION, Ramp, ramps_of
from ...registers.model import Access, Register, to_raw
from ...registers.spi_format import SpiFormat, TaggedFormat
from .axis import Axis
from .board import BoardEnd
from .options import PLAIN_CHIP, ListedOptions, ListedState
from .plain_emulator import ACCELERATION, SPEED, PlainEmulatorBase


class PlainChip(PlainEmulatorBase):
    """Registers, and what leads to them: datagrams on SPI, a UART, an evaluation board. Safe to use from several
    threads."""

    reply_delay_bits = 8

    def __init__(self, model: Model, clock: Clock, options: ListedOptions) -> None:
        """A chip that has just been switched on."""
        super().__init__(model, clock, options)
        self._ramps = ramps_of(model.table)
        self._rows: Mapping[int, tuple[Register, ...]] = {
            row.address: model.table.meanings(row.address) for row in model.table
        }
        # A board keeps what it wrote to registers that nobody can read, and answers with that.
        kept = isinstance(model.spi, TaggedFormat)
        self._board = BoardEnd(model, self.held_or_read if kept else self.read, self.write)
        self._held: dict[int, int] = {}
        self._data = 0
        """What the next datagram brings: it belongs to the latest."""
        self._writes = 0
        self._power_on()

    # --- wires -----------------------------------------------------------------------------------

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        """Answer one datagram on SPI, or a command of an evaluation board where none is known of the chip.

        Raises ValueError for a frame of another length, ConnectionError while unplugged, and TimeoutError while silent.
        """
        self.faults.require_plugged(self.model)
        spi = self._model.spi
        if spi is not None:
            with self._lock:
                self._run_until(at_s)
                if isinstance(spi, SpiFormat):
                    answered = self._told_datagram(spi, frame)
                else:
                    answered = self._tagged_datagram(spi, frame)
            return self.faults.pass_on(self.model, answered, self._noise)
        if not datagram40.speaks(self.model):
            reply = self._board.receive(frame, at_s)
            if reply is None:
                raise TimeoutError(f"an emulated {self.model} does not answer this")
            return self.faults.pass_on(self.model, reply, self._noise)
        request = datagram40.Request.decode(frame)
        with self._lock:
            self._run_until(at_s)
            reply = datagram40.Reply(0, self._data).encode()
            if request.write:
                self._write(request.address, request.data)
            self._data = request.data if request.write else self._read(request.address)
        return self.faults.pass_on(self.model, reply, self._noise)

    def _told_datagram(self, form: SpiFormat, frame: bytes) -> bytes:
        """The answer to a datagram of a told format: what was read, or what was written."""
        request = spi_datagram.decode(form, frame)
        earlier = self._data
        if request.write:
            self._write(request.address, request.data)
        self._data = request.data if request.write else self._read(request.address)
        return spi_datagram.answer(form, earlier if form.answer == "next" else self._data)

    def _tagged_datagram(self, form: TaggedFormat, frame: bytes) -> bytes:
        """The answer to a datagram that says by its upper bits what it writes: the status that was selected before."""
        if len(frame) != form.frame_bytes:
            raise ValueError(f"a datagram has {form.frame_bytes} bytes, not {len(frame)}")
        selected = self._held.get(form.selecting, 0) >> form.select_lsb & (1 << form.select_bits) - 1
        status = self._read(selected)
        datagram = int.from_bytes(frame, "big") & (1 << form.word_bits) - 1
        address = form.address_of(datagram)
        self._write(address, datagram & (1 << form.width_of(address)) - 1)
        return (status << 8 * form.frame_bytes - form.word_bits).to_bytes(form.frame_bytes, "big")

    def uart(self, datagram: bytes, at_s: float | None = None) -> bytes:
        """Answer one datagram of the single-wire UART; b"" where no answer is due: a write, another node, a wrong CRC.

        Raises ConnectionError while unplugged, and TimeoutError while silent.
        """
        self.faults.require_plugged(self.model)
        form = UartForm(None if self._model.uart == "plain" else self.options.node)
        head = form.read_bytes - 2
        sound = len(datagram) in (form.read_bytes, form.write_bytes) and crc8(datagram[:-1]) == datagram[-1]
        if not sound or datagram[0] & 0xF != SYNC or (head == 2 and datagram[1] != self.options.node):
            return b""
        address, write = datagram[head] & ~WRITE_BIT, bool(datagram[head] & WRITE_BIT)
        if write is not (len(datagram) == form.write_bytes):
            return b""
        with self._lock:
            self._run_until(at_s)
            if write:
                self._writes += 1
                self._write(address, int.from_bytes(datagram[-5:-1], "big"))
                return b""
            word = self._writes & 0xFF if address == IFCNT else self._read(address)
        return self.faults.pass_on(self.model, form.reply(address, word), self._noise)

    def board(self, frame: bytes, at_s: float | None = None) -> bytes | None:
        """Answer one command of the evaluation board that the chip stands on; None where it is for another one."""
        return self._board.receive(frame, at_s)

    def read(self, address: int, at_s: float | None = None) -> int:
        """The word that a bus reads at `address`."""
        with self._lock:
            self._run_until(at_s)
            return self._read(address)

    def write(self, address: int, data: int, at_s: float | None = None) -> None:
        """Write 32 bits as a bus does."""
        with self._lock:
            self._run_until(at_s)
            self._write(address, data)

    def held_or_read(self, address: int, at_s: float | None = None) -> int:
        """What was written at `address`, else what a bus reads there."""
        with self._lock:
            self._run_until(at_s)
            return self._held.get(address, self._read(address))

    def held(self, address: int) -> int:
        """The bits at `address`, whether or not a bus may read them."""
        with self._lock:
            return self._held.get(address, 0)

    # --- registers -------------------------------------------------------------------------------

    def _read(self, address: int) -> int:
        for ramp, axis in zip(self._ramps, self._axes, strict=True):
            if address == ramp.position.address:
                return to_raw(axis.counter, ramp.position.width)
            if address == ramp.speed.address:
                return to_raw(round(axis.speed), ramp.speed.width)
        rows = self._rows.get(address, ())
        return self._held.get(address, 0) if any(row.access.readable for row in rows) else 0

    def _write(self, address: int, data: int) -> None:
        row = next((row for row in self._rows.get(address, ()) if row.access.writable), None)
        if row is None:
            return
        held, mask = self._held.get(address, 0), row.write_mask
        for part in row.fields or (row,):
            if part.access is Access.R_W1C:
                flags = getattr(part, "mask", row.mask)
                data = (data & ~flags) | (held & flags & ~data)
        self._held[address] = (held & ~mask) | (data & mask)
        for ramp, axis in zip(self._ramps, self._axes, strict=True):
            if row in ramp.moving:
                self._drive(ramp, axis, row)

    def _drive(self, ramp: Ramp, axis: Axis, written: Register) -> None:
        """Have the axis do what its registers say."""
        if written is ramp.position:
            axis.position = float(ramp.position.decode(self._held[ramp.position.address]))
        axis.max_speed = self._held.get(ramp.max_speed.address, 0)
        axis.acceleration = self._held.get(ramp.acceleration.address, 0)
        mode = ramp.mode.unpack(self._held.get(ramp.mode.register.address, 0))
        if mode == POSITION:
            axis.go_to(ramp.target.decode(self._held.get(ramp.target.address, 0)))
        elif mode in (FORWARD, BACKWARD):
            axis.turn(axis.max_speed if mode == FORWARD else -axis.max_speed)
        else:
            axis.turn(round(axis.speed))

    def _power_on(self) -> None:
        self._held = {row.address: row.reset for row in self._model.table if row.reset is not None and not row.when}
        self._axes = [Axis() for _ in self._ramps]
        self._data = self._writes = 0
        for ramp, axis in zip(self._ramps, self._axes, strict=True):
            for row, value in ((ramp.max_speed, SPEED), (ramp.acceleration, ACCELERATION)):
                self._held[row.address] = min(value, row.maximum)
            self._drive(ramp, axis, ramp.mode.register)

    # --- plant ----------------------------------------------------------------------------------

    def _describe(self) -> ListedState:
        return self._told(PLAIN_CHIP, self.options.node)
