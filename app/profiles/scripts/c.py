"""A profile as arrays for firmware in C."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...devices.core.tmcl_frames import writing
from ...errors import UsageError
from ...links import datagram32, datagram40, tmcl
from ...links.datagram_uart import UartForm
from ...registers.catalog import Model
from ...registers.spi_format import TaggedFormat
from .plan import Plan, Write, meaning
from .text import c_name, c_remark, lines

_REGISTER = """\
/* One register: its address as in the data sheet, without the bit that says write, and the whole word. */
struct {name}_write {{
    uint8_t address;
    uint32_t value;
}};
"""
_COMMAND = """\
/* One TMCL command: SAP (5) or SGP (9), number of the parameter, motor or bank, value. */
struct {name}_write {{
    uint8_t command;
    uint8_t type;
    uint8_t motor;
    int32_t value;
}};
"""
_UART = -1
"""Stands for datagrams of a UART among lengths of SPI datagrams."""
_FRAMES: Mapping[int, str] = {
    32: """\
    const uint32_t word = (uint32_t)write->address << 25 | write->value;
    frame[0] = (uint8_t)(word >> 24);
    frame[1] = (uint8_t)(word >> 16);
    frame[2] = (uint8_t)(word >> 8);
    frame[3] = (uint8_t)word;
""",
    40: """\
    frame[0] = (uint8_t)(write->address | 0x80u);
    frame[1] = (uint8_t)(write->value >> 24);
    frame[2] = (uint8_t)(write->value >> 16);
    frame[3] = (uint8_t)(write->value >> 8);
    frame[4] = (uint8_t)write->value;
""",
    _UART: """\
    uint8_t crc = 0;
    size_t i, bit;
    frame[0] = 0x05u;
    frame[1] = {macro}_NODE;
    frame[2] = (uint8_t)(write->address | 0x80u);
    frame[3] = (uint8_t)(write->value >> 24);
    frame[4] = (uint8_t)(write->value >> 16);
    frame[5] = (uint8_t)(write->value >> 8);
    frame[6] = (uint8_t)write->value;
    for (i = 0; i < 7; i++)
        for (bit = 0; bit < 8; bit++)
            crc = (uint8_t)(((crc >> 7) ^ (frame[i] >> bit & 1u)) ? (crc << 1) ^ 0x07u : crc << 1);
    frame[7] = crc;
""",
    0: """\
    const uint32_t value = (uint32_t)write->value;
    uint8_t sum = 0;
    size_t i;
    frame[0] = {macro}_MODULE;
    frame[1] = write->command;
    frame[2] = write->type;
    frame[3] = write->motor;
    frame[4] = (uint8_t)(value >> 24);
    frame[5] = (uint8_t)(value >> 16);
    frame[6] = (uint8_t)(value >> 8);
    frame[7] = (uint8_t)value;
    for (i = 0; i < 8; i++)
        sum = (uint8_t)(sum + frame[i]);
    frame[8] = sum;
""",
}
_TOLD = -2
"""Stands for datagrams whose format a table tells."""
_FRAME_BYTES = {
    32: datagram32.FRAME_BYTES,
    40: datagram40.FRAME_BYTES,
    _UART: UartForm().write_bytes,
    0: tmcl.FRAME_BYTES,
}
_FUNCTIONS = """\
/* The bytes for the wire, in their order. */
static inline void {name}_frame(const struct {name}_write *write, uint8_t frame[{macro}_FRAME_BYTES])
{{
{frame}}}

/* Yours: sends one frame and answers 0 when it went out{and_came}. */
typedef int (*{name}_send)(void *bus, const uint8_t frame[{macro}_FRAME_BYTES]);

/* Sends everything in the order that is safe. The motor has to stand at its target, as it does after a reset.
   Answers how many went out: all is well when that is {macro}_WRITES. Else the write of that number failed,
   and nothing after it was sent. */
static inline size_t {name}_apply({name}_send send, void *bus)
{{
    static const struct {{
        const struct {name}_write *writes;
        size_t count;
    }} parts[] = {{
{parts}    }};
    uint8_t frame[{macro}_FRAME_BYTES];
    size_t part, i, sent = 0;
    for (part = 0; part < sizeof parts / sizeof *parts; part++)
        for (i = 0; i < parts[part].count; i++, sent++) {{
            {name}_frame(&parts[part].writes[i], frame);
            if (send(bus, frame) != 0)
                return sent;
        }}
    return sent;
}}
"""


def render(plan: Plan) -> str:
    """The whole header, in C99 without a library."""
    return "\n".join(_lines(plan)) + "\n"


def prefix(plan: Plan) -> str:
    """What every name in the header begins with; capitals of it its macros."""
    return c_name(plan.name)


def _form(family: Model) -> int:
    """The kind of its frames: bits of an SPI datagram, 0 for TMCL, `_UART` or `_TOLD`. Raises UsageError where none is
    known that C could send."""
    if family.spi is not None and family.spi.word_bits <= 32:
        return _TOLD
    if family.kind == "chip" and not family.uart_alone and (family.spi is not None or not family.datagram_bits):
        why = "has words of more than 32 bits" if family.spi is not None else "has no datagrams on SPI that are known"
        raise UsageError(f"a {family.title} {why}: there is no C of it, but Python and curl")
    return _UART if family.uart_alone else family.datagram_bits


def _frame_bytes(family: Model) -> int:
    return _FRAME_BYTES[_form(family)] if family.spi is None else family.spi.frame_bytes


def _frame_of(family: Model) -> str:
    """The lines that make a frame."""
    spi = family.spi
    if spi is None:
        return _FRAMES[_form(family)]
    if isinstance(spi, TaggedFormat):
        tag = f"((uint32_t)write->address & 0x{~spi.written & 0xF:X}u) << {spi.tag_lsb} | write->value"
        lines = [f"const uint32_t word = {tag};"]
        lines += [f"frame[{place}] = (uint8_t)(word >> {8 * (spi.frame_bytes - 1 - place)});" for place in range(3)]
        return "".join(f"    {line}\n" for line in lines)
    bit = spi.write_is << (0 if spi.write_bit == "low" else 8 * spi.head_bytes - 1)
    shifted = "(uint32_t)write->address << 1" if spi.write_bit == "low" else "(uint32_t)write->address"
    lines = [f"const uint32_t head = {shifted} | 0x{bit:X}u;"]
    for place in range(spi.head_bytes):
        lines.append(f"frame[{place}] = (uint8_t)(head >> {8 * (spi.head_bytes - 1 - place)});")
    places = range(spi.data_bits // 8)
    for place in places:
        shift = 8 * (place if spi.byte_order == "little" else places[-1] - place)
        lines.append(f"frame[{spi.head_bytes + place}] = (uint8_t)(write->value >> {shift});")
    return "".join(f"    {line}\n" for line in lines)


def _lines(plan: Plan) -> Iterator[str]:
    name, family = prefix(plan), plan.family
    macro, module = name.upper(), family.kind == "module"
    yield "/*"
    yield f" * Profile: {c_remark(plan.name)}"
    yield f" * {plan.about}"
    yield from (f" * {c_remark(line)}".rstrip() for line in (*lines(plan.note), *plan.left_out))
    yield " */"
    yield f"#ifndef {macro}_H"
    yield f"#define {macro}_H"
    yield ""
    yield "#include <stddef.h>"
    yield "#include <stdint.h>"
    yield ""
    yield f"#define {macro}_WRITES {plan.count}u"
    yield f"#define {macro}_FRAME_BYTES {_frame_bytes(family)}u"
    if family.uart_alone:
        yield f"#define {macro}_NODE 0u /* address of the chip on its UART */"
    if module:
        yield f"#define {macro}_MODULE 1u /* address of the module on its line */"
    yield ""
    yield (_COMMAND if module else _REGISTER).format(name=name)
    for index, part in enumerate(plan.parts):
        yield f"/* {c_remark(part.title)} */"
        yield f"static const struct {name}_write {name}_part_{index}[] = {{"
        for write in part.writes:
            where = "" if write.register.axis is None or family.axes == 1 else f", axis {write.register.axis}"
            said = c_remark(f"{write.register.name}{where}: {meaning(write)}")
            yield f"    {_entry(family, write)} /* {said} */"
        yield "};"
        yield ""
    yield _functions(plan).rstrip()
    yield ""
    yield f"#endif /* {macro}_H */"


def _entry(family: Model, write: Write) -> str:
    if family.kind == "module":
        request = writing(0, write.register, write.value)
        return f"{{{request.opcode}, {request.type}, {request.motor}, {_int32(request.value)}}},"
    return f"{{0x{write.register.address:02X}u, 0x{write.whole_word:08X}u}},"


def _int32(value: int) -> str:
    """The lowest one has no literal of its own: its digits are those of a number too large for an int."""
    return "-2147483647 - 1" if value == -(1 << 31) else str(value)


def _functions(plan: Plan) -> str:
    name, bits = prefix(plan), _form(plan.family)
    macro = name.upper()
    counted = (
        f"        {{{name}_part_{index}, sizeof {name}_part_{index} / sizeof *{name}_part_{index}}},\n"
        for index in range(len(plan.parts))
    )
    return _FUNCTIONS.format(
        name=name,
        macro=macro,
        frame=_frame_of(plan.family).replace("{macro}", macro),
        parts="".join(counted),
        and_came=" and the module said that it was done" if bits == 0 else "",
    )
