"""What a frame of the log says, for people: TMCL commands, datagrams of 32 bits and of 40, and those of a UART."""

from __future__ import annotations

from ...devices.core.tmcl_frames import spelled
from ...errors import BadReply
from ...links import datagram32, datagram40, datagram_uart, tmcl
from ...links.register_access import BoardAccess
from ...links.spi_datagram import data_of, decode
from ...registers import catalog
from ...registers.catalog import MODELS, Model
from ...registers.model import Register, RegisterTable
from ...registers.spi_format import Spi, SpiFormat
from ...registers.tmcl.commands import Opcode, Status


def frame_text(model: str, tx: bytes, rx: bytes | None) -> str:
    """One transaction with a `model`: the question, and the answer where there is one."""
    known = catalog.find_model(model)
    if known.spi is not None and len(tx) == known.spi.frame_bytes and not _is_uart(model, tx):
        return _told(known.table, known.spi, tx, rx)
    if len(tx) == tmcl.FRAME_BYTES:
        return _board(known, tx, rx) if known.kind == "chip" else _tmcl(tx, rx)
    if tx == datagram40.STATUS_FRAME:
        return "eight clocks" if not rx else f"eight clocks (status {rx[0]:#04x})"
    if len(tx) == datagram40.FRAME_BYTES:
        return _datagram40(MODELS[model].table, tx, rx)
    if datagram_uart.kind_of(model):
        return _uart(model, tx, rx)
    if len(tx) == datagram32.FRAME_BYTES:
        return _datagram(MODELS[model].table, tx, rx)
    return f"{len(tx)} bytes"


def _is_uart(model: str, tx: bytes) -> bool:
    """Whether these bytes are a datagram of its UART, by sync and CRC: its SPI may have some as long."""
    return bool(datagram_uart.kind_of(model)) and tx[0] & 0xF == datagram_uart.SYNC and datagram_uart.is_sound(tx)


def _told(table: RegisterTable, form: Spi, tx: bytes, rx: bytes | None) -> str:
    """A datagram of a told format; of one that answers later, what comes back belongs to the datagram before."""
    whole = rx is not None and len(rx) == form.frame_bytes
    if not isinstance(form, SpiFormat):
        datagram = int.from_bytes(tx, "big")
        address = form.address_of(datagram)
        register = table.at(address, write=True)
        name = f"{address:#04x}" if register is None else register.name
        return f"{name} := {_shown(register, datagram & (1 << form.width_of(address)) - 1)}"
    request = decode(form, tx)
    register = table.at(request.address, write=request.write)
    name = f"{request.address:#04x}" if register is None else register.name
    asked = f"{name} := {_shown(register, request.data)}" if request.write else f"read {name}"
    if rx is None or not whole:
        return asked
    if form.answer == "next":
        return f"{asked} (of the datagram before {data_of(form, rx):#x})"
    return asked if request.write else f"{asked} -> {_shown(register, data_of(form, rx))}"


def _tmcl(tx: bytes, rx: bytes | None) -> str:
    request = tmcl.Request.decode(tx)
    asked = spelled(request)
    if not rx:
        return asked
    try:
        reply = tmcl.check_reply("", tx, rx)
    except BadReply:
        return f"{asked} -> ?"
    if not reply.ok:
        return f"{asked} -> {reply.status_text} ({reply.status})"
    if request.opcode == Opcode.GET_VERSION and not tmcl.has_plain_reply(tx) and not tmcl.sound(rx):
        return f"{asked} -> {tmcl.version_string(rx)}"
    if reply.status == Status.STORED:
        return f"{asked} -> {reply.status_text}"
    return f"{asked} -> {reply.value}"


def _datagram40(table: RegisterTable, tx: bytes, rx: bytes | None) -> str:
    """Pipelined: what comes back belongs to the datagram before, so only its bits are told."""
    request = datagram40.Request.decode(tx)
    register = table.at(request.address, write=request.write)
    name = f"{request.address:#04x}" if register is None else register.name
    asked = f"{name} := {_shown(register, request.data)}" if request.write else f"read {name}"
    if rx is None or len(rx) != datagram40.FRAME_BYTES:
        return asked
    reply = datagram40.Reply.decode(rx)
    return f"{asked} (status {reply.status:#04x}, of the datagram before {reply.data:#010x})"


def _uart(model: str, tx: bytes, rx: bytes | None) -> str:
    """A write is answered by the chip's count of writes."""
    table, form = MODELS[model].table, datagram_uart.form_of(model)
    if len(tx) not in (form.read_bytes, form.write_bytes):
        return f"{len(tx)} bytes"
    write, address = form.is_write(tx), form.register_of(tx)
    register = table.at(address, write=write)
    name = f"{address:#04x}" if register is None else register.name
    asked = f"{name} := {_shown(register, int.from_bytes(tx[-5:-1], 'big'))}" if write else f"read {name}"
    if not rx:
        return asked
    try:
        data = form.data_of(datagram_uart.IFCNT if write else address, rx)
    except ValueError:
        return f"{asked} -> ?"
    return f"{asked} (write {data & 0xFF} of the chip)" if write else f"{asked} -> {_shown(register, data)}"


def _board(model: Model, tx: bytes, rx: bytes | None) -> str:
    """Registers through an evaluation board; anything else that is asked of it is TMCL."""
    request, access = tmcl.Request.decode(tx), BoardAccess(slot=model.slot)
    if request.opcode not in (access.read_opcode, access.write_opcode):
        return _tmcl(tx, rx)
    write = request.opcode == access.write_opcode
    address = access.address_of(tx)
    register = model.table.at(address, write=write)
    name = f"{address:#04x}" if register is None else register.name
    asked = f"{name} := {_shown(register, request.value & datagram40.DATA_MASK)}" if write else f"read {name}"
    if not rx:
        return asked
    try:
        reply = tmcl.check_reply("", tx, rx)
    except BadReply:
        return f"{asked} -> ?"
    if not reply.ok:
        return f"{asked} -> {reply.status_text} ({reply.status})"
    return asked if write else f"{asked} -> {_shown(register, reply.value & datagram40.DATA_MASK)}"


def _shown(register: Register | None, data: int) -> str:
    """A word as a number where it is one, else as its bits."""
    return f"{data:#010x}" if register is None or register.fields else str(register.decode(data))


def _datagram(table: RegisterTable, tx: bytes, rx: bytes | None) -> str:
    request = datagram32.Request.decode(tx)
    register = table.at(request.address)
    if register is None:
        name = f"{request.address:#04x}"
    else:
        name = register.name if register.axis is None else f"{register.name}.{register.axis}"

    def shown(data: int) -> str:
        return f"{data:#08x}" if register is None or register.fields else str(register.decode(data))

    if not request.read:
        return f"{name} := {shown(request.data)}"
    if rx is None or len(rx) != datagram32.FRAME_BYTES:
        return f"read {name}"
    return f"read {name} -> {shown(datagram32.Reply.decode(rx).data)}"
