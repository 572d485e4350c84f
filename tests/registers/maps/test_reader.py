"""Register maps: the documented examples load, every mistake has its line, and no file whatever makes it stumble."""

from __future__ import annotations

import random
import re
import time
from pathlib import Path

import pytest

from app.registers.maps.csv_import import COLUMNS, read_csv
from app.registers.maps.findings import TOLD_MAX, Finding, UnreadableMap
from app.registers.maps.reader import BYTES_MAX, RegisterMap, read
from app.registers.maps.shapes import REGISTERS_MAX, FieldShape, HeadShape, RegisterShape, SpiShape
from app.registers.model import Access

DOCUMENT = (Path(__file__).parents[3] / "docs" / "register-maps.md").read_text(encoding="utf-8")


def example(kind: str) -> bytes:
    found = re.search(rf"```{kind}\n(.*?)```", DOCUMENT, re.DOTALL)
    assert found is not None
    return found[1].encode()


EXAMPLE = example("toml")
SMALL = b'format = 1\ntitle = "x"\n[[register]]\nname = "A"\naddress = 1\n'


TOLD = b"""\
format = 1
title = "Own datagrams"
axes = 1

[spi]
data_bits = 24
address_bits = 10
write_bit = "low"
write_is = 0
byte_order = "little"
answer = "same"
datagram_bits = 40

[[register]]
name = "CTRL"
address = 0x0
  [[register.field]]
  name = "how"
  lsb = 4
  width = 2
  role = "mode"
[[register]]
name = "GOTO"
address = 0x1
role = "target"
[[register]]
name = "WHERE"
address = 0x3ff
role = "position"
[[register]]
name = "PACE"
address = 0x3
role = "velocity"
[[register]]
name = "SPEED"
address = 0x4
role = "max_velocity"
[[register]]
name = "GAIN"
address = 0x6
role = "acceleration"
[[register]]
name = "FLAGS"
address = 0x7
role = "status"
"""
"""Every key of datagrams, every role."""


def findings(content: bytes | str) -> list[Finding]:
    with pytest.raises(UnreadableMap) as caught:
        read("map", content if isinstance(content, bytes) else content.encode())
    return [Finding(each["line"], each["where"], each["what"]) for each in caught.value.findings]


def test_the_documented_example_is_what_it_says() -> None:
    found = read("ramp-core", EXAMPLE)
    assert (found.head.title, found.head.axes, found.head.clock_hz) == ("Ramp core 2", 1, 16_000_000)
    assert (found.head.spi is None, found.head.uart) == (False, None)
    mode, actual, _, _, vmax, target, gstat = found.table
    assert (mode.name, mode.address, mode.axis, mode.width, mode.reset) == ("MODE", 0x20, 0, 8, 0)
    assert [(part.name, part.lsb, part.width, part.reset) for part in mode.fields] == [
        ("rampmode", 0, 2, 0),
        ("shaft", 7, 1, 0),
    ]
    assert dict(mode.fields[0].values) == {0: "positioning", 1: "forward", 2: "backward", 3: "hold"}
    assert (actual.signed, actual.unit, actual.volatile, actual.reset) == (True, "microsteps", True, None)
    assert (vmax.minimum, vmax.maximum) == (0, 8_388_096)
    assert target.untold == frozenset()
    assert actual.untold == {"reset"}
    assert (gstat.access, gstat.read_clears, gstat.axis) == (Access.R, True, None)


def test_the_documented_table_is_the_same_map_as_its_toml() -> None:
    found, text = read_csv("registers", example("csv"))
    again = read("registers", text.encode())
    assert [repr(row) for row in again.table] == [repr(row) for row in found.table]
    assert again.head == found.head
    assert [(row.name, row.address, row.signed) for row in found.table] == [
        ("MODE", 0x20, False),
        ("OFFSET", 0x21, True),
    ]
    assert [part.name for part in found.table.registers[0].fields] == ["level"]


def test_the_document_names_every_key() -> None:
    for shape in (HeadShape, SpiShape, RegisterShape, FieldShape):
        for name, key in shape.model_fields.items():
            assert re.search(rf"\b{key.alias or name}\b", DOCUMENT), name
    assert all(f"`{column}`" in DOCUMENT for column in COLUMNS)


def test_all_mistakes_are_told_at_once_each_with_its_line() -> None:
    text = """format = 2
axes = 9
colour = "red"

[[register]]
name = "a b"
address = 300
values = { x = "y" }

[[register]]
address = 1
  [[register.field]]
  name = "q"
  lsb = "1"
  size = 1

[[register]]
name = "A"
address = 0x01
reset = 16
width = 4
range = [5, 3]
values = { 0 = "a", 99 = "c" }
  [[register.field]]
  name = "f"
  lsb = 1
  width = 2
  [[register.field]]
  name = "F"
  lsb = 2
  width = 3

[[register]]
name = "C"
address = 2
[[register]]
name = "c"
address = 2
"""
    assert [(each.line, each.where) for each in findings(text)] == [
        (1, "format"),
        (1, "title"),
        (2, "axes"),
        (3, "colour"),
        (6, "register a b, name"),
        (7, "register a b, address"),
        (10, "register 2 of the file, name"),
        (14, "register 2 of the file, field q, lsb"),
        (15, "register 2 of the file, field q, size"),
        (20, "register A"),
        (22, "register A"),
        (23, "register A"),
        (29, "register A, field F"),
        (30, "register A, field F"),
        (37, "register c"),
        (38, "register c"),
    ]


@pytest.mark.parametrize(
    ("change", "line", "what"),
    [
        (('title = "x"', "title = x"), 2, "no TOML"),
        (('title = "x"', 'title = "x'), 2, "no TOML"),
        (("[[register]]", "[[register]"), 3, "no TOML"),
        (('name = "A"', 'name = "A"\nname = "B"'), 5, "no TOML"),
        (("address = 1", "address = 1\n[spi]\n[spi]"), 7, "no TOML"),
        (("address = 1", 'address = 1\nhelp = """a\nb"""\naccess = "X"'), 8, "allowed is 'R', 'W', 'RW' or 'R+WC'"),
        (("address = 1", 'address = 1\n"ac\\u0063ess" = "X"'), 6, "allowed is"),
        (("address = 1", "address = 128"), 5, "is 128, allowed is 127 or less"),
        (("address = 1", "address = true"), 5, "has to be a whole number"),
        (("address = 1", "address = 1\nrange = [\n1,\n'x',\n]"), 8, "has to be a whole number"),
        (("address = 1", "address = 1\naxis = 0"), 6, "say `axes` at the head"),
        (("address = 1", "address = 1\nwidth = 99999999999999999999999999"), 6, "allowed is 32 or less"),
        (("address = 1", "address = 1\n[register.x]"), 6, "no such key; there are name"),
        (('title = "x"', 'title = "x"\nspi.mode = 3'), 3, "no such key; there are data_bits"),
        (('title = "x"', 'title = "a\\u0000b"'), 2, "one line of text"),
        (('title = "x"', f"title = {'[' * 500}{']' * 500}"), 2, "nested deeper"),
        (('title = "x"', f"{'a.' * 500}a = 1"), 2, "nested deeper"),
        (('title = "x"', f"title = {{ {'a.' * 500}a = 1 }}"), 2, "nested deeper"),
        (("[[register]]", "[register]"), 3, "has to be a list"),
        (('title = "x"', f"title = {'9' * 5000}"), 2, "so many digits"),
        (("address = 1", "address = 1_"), 5, "no TOML"),
        (('title = "x"', 'title = "x"\naxes = 2'), 3, "is 2, and the registers make 0 ramp generators"),
    ],
)
def test_a_mistake_is_told_with_its_line_and_what_is_allowed(change: tuple[str, str], line: int, what: str) -> None:
    found = findings(SMALL.decode().replace(*change))
    assert (found[0].line, what in found[0].what) == (line, True), found


def test_what_is_no_text_or_too_long_is_refused() -> None:
    assert findings(b"\n\n\xff\xfe")[0].line == 3
    assert findings(b"#" * (BYTES_MAX + 1))[0].what.endswith(f"at most {BYTES_MAX} are read")
    assert read("map", b"\xef\xbb\xbf" + SMALL.replace(b"\n", b"\r\n")).head.title == "x"


def test_many_registers_are_read_and_more_are_refused_quickly() -> None:
    head = 'format = 1\ntitle = "x"\n'
    many = [f'[[register]]\nname = "R{index}"\naddress = {index % 128}\naccess = "R"\n' for index in range(3000)]
    told = findings(head + "".join(many[:REGISTERS_MAX]))
    assert len(told) == TOLD_MAX
    assert told[0].what == "address 0x00 is that of the one on line 5"
    assert any("allowed is at most 1000" in each.what for each in findings(head + "".join(many)))


@pytest.mark.parametrize(
    ("change", "line", "what"),
    [
        (("data_bits = 24", "data_bits = 20"), 6, "allowed is 8, 16, 24, 32, 40, 48, 56 or 64"),
        (("address_bits = 10", "address_bits = 16"), 7, "allowed is 15 or less"),
        (('write_bit = "low"', 'write_bit = "first"'), 8, "allowed is 'high' or 'low'"),
        (("write_is = 0", "write_is = 2"), 9, "allowed is 0 or 1"),
        (("datagram_bits = 40", "datagram_bits = 32"), 12, "is 32, and the other keys make 40"),
        (("address = 0x3ff", "address = 0x400"), 28, "is 1024, allowed is 1023 or less"),
        (('role = "mode"', 'role = "modus"'), 21, "allowed is 'mode'"),
        (('role = "mode"', 'role = "target"'), 21, "allowed is 'mode'"),
        (('role = "velocity"', 'role = "position"'), 33, "the role position of axis 0 is that of WHERE on line 29"),
        (('role = "velocity"\n', ""), 3, "registers make 0 ramp generators"),
        (("width = 2", "width = 3"), 3, "the mode has 2 bits"),
        (('role = "status"', 'role = "status"\nwidth = 25'), 46, "is 25, allowed is 24 or less"),
        (('role = "status"', 'role = "status"\n[uart]'), 28, "is 1023, allowed is 127 or less"),
        (('"SPEED"', '"SPEED"\naccess = "R"'), 3, "registers make 0 ramp generators"),
    ],
)
def test_a_mistake_in_datagrams_or_roles_is_told(change: tuple[str, str], line: int, what: str) -> None:
    assert read("map", TOLD).head.spi is not None
    found = findings(TOLD.decode().replace(*change))
    assert (found[0].line, what in found[0].what) == (line, True), found


@pytest.mark.parametrize(
    ("text", "line", "what"),
    [
        ("", 1, "register and address have to be there"),
        ("name,address\n", 1, "'name' is no column"),
        ("register,address\nA,q\n", 2, "has to be a whole number"),
        ("register,address\nA,1\nB,1\n", 3, "is that of the one on line 2"),
        ("register,field,address\n,f,\n", 2, "below its register"),
        ("register;address;signed\nA;1;perhaps\n", 2, "has to be true or false"),
        ("register\taddress\nA\t1\t2\n", 2, "3 cells, and 2 columns"),
        ('register,address\nA,"1\n', 2, "no CSV"),
        ("register,address,minimum\nA,1,0\n", 2, "has to be a whole number"),
        ("register,address\n", 1, "at least 1"),
    ],
)
def test_mistakes_of_a_table_are_told_with_their_lines(text: str, line: int, what: str) -> None:
    with pytest.raises(UnreadableMap) as caught:
        read_csv("map", text.encode())
    first = caught.value.findings[0]
    assert (first["line"], what in first["what"]) == (line, True), caught.value.findings


TOKENS: tuple[bytes, ...] = (
    b"[[",
    b"]]",
    b"[",
    b"]",
    b"{",
    b"}",
    b'"',
    b'"""',
    b"'",
    b"=",
    b".",
    b",",
    b"#",
    b"\n",
    b"\x00",
    b"\xff",
    b"-1",
)
TOKENS += (
    b"inf",
    b"1e400",
    b"0x",
    b"99999999999999999999",
    b"true",
    b"[[register]]\n",
    b"[register.field]\n",
    b"\\u0000",
)


def mutated(content: bytes, random: random.Random) -> bytes:
    for _ in range(random.choice((1, 1, 1, 2, 5, 20))):
        at, lines = random.randrange(len(content) + 1), content.split(b"\n")
        line = random.randrange(len(lines))
        match random.randrange(7):
            case 0:
                content = content[:at] + random.choice(TOKENS) + content[at:]
            case 1:
                content = content[:at] + content[at + random.randrange(1, 20) :]
            case 2:
                content = content[:at] + bytes((random.randrange(256),)) + content[at + 1 :]
            case 3:
                content = content[:at]
            case 4:
                content = b"\n".join((*lines[:line], *lines[line + 1 :]))
            case 5:
                content = b"\n".join((*lines[:line], *random.sample(lines, min(3, len(lines))), *lines[line:]))
            case 6:
                content = content.replace(random.choice((b"0", b"1", b"=", b'"', b"name")), random.choice(TOKENS), 3)
    return content


def outcome(kind: str, content: bytes) -> RegisterMap | UnreadableMap:
    try:
        return read_csv("map", content)[0] if kind == "csv" else read("map", content)
    except UnreadableMap as error:
        return error


@pytest.mark.parametrize("kind", ["toml", "csv", "told"])
def test_a_thousand_broken_files_are_refused_with_the_line_or_load(kind: str) -> None:
    random_, good, loaded = random.Random(15), TOLD if kind == "told" else example(kind), 0
    began_s = time.perf_counter()
    for _ in range(1000):
        content = mutated(good, random_)
        found = outcome(kind, content)
        if isinstance(found, RegisterMap):
            loaded += 1
            continue
        lines = content.count(b"\n") + content.count(b"\r") + 1
        assert found.findings
        assert all(1 <= each["line"] <= lines for each in found.findings), content
    assert 20 < loaded < 900
    assert time.perf_counter() - began_s < 60
