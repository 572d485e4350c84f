"""A profile as a Python program for stepscope's client."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator, Mapping

from ..rules import Busy
from .plan import Plan, Write, meaning
from .preconditions import busy_of, target_of
from .text import WIDTH, lines, one_line

GLUE = "\u00a0"
"""A space at which no line is broken."""

# Nothing that people wrote may stand in the first two lines: there a remark can name another encoding of the file.
_HEAD = '''\
#!/usr/bin/env python3
"""Write a stepscope profile to a device through a running server, and check every read-back.

Needs the stepscope package. The server is --url, else STEPSCOPE_URL; one that asks for a token finds it in
STEPSCOPE_TOKEN. Ends with 0 when the device holds the profile, 1 when it does not, 2 for a wrong command line.
"""
'''
_BODY = '''


def main() -> int:
    """Write all of it, in its order; the first write that fails ends it."""
    parser = argparse.ArgumentParser(description="Write a stepscope profile to a device.")
    parser.add_argument("--url", help="the server, e.g. http://127.0.0.1:8000 [default: STEPSCOPE_URL]")
    parser.add_argument("--device", default=DEVICE, help="id of the device [default: %(default)s]")
    arguments = parser.parse_args()
    try:
        with Bench(arguments.url) as bench, bench.lease(f"profile of a {MODEL}"):
            return apply(bench, arguments.device)
    except ClientError as error:
        return failed(str(error))


def apply(bench: Bench, name: str) -> int:
    """Check that it is the right device and that its motors stand, then write."""
    device = bench.device(name)
    if device.model != MODEL:
        return failed(f"{name} is a {device.model}; this profile is of a {MODEL}")
    for register, axis, field, why in BUSY:
        held = bench.read(name, register, axis)
        if held.fields[field] if field else held.value:
            return failed(why)
    for number in range(len(device.axes)):
        state = bench.axis(name, number)
        if state.moving:
            return failed(f"axis {number} of {name} moves: stop it first")
        if TARGET:  # no register that follows may give it somewhere to go
            bench.write(name, TARGET, state.position, number)
        elif state.target_position not in (None, state.position):
            return failed(f"axis {number} of {name} stands, and not at its target: stop it first")
    for index, (register, axis, value) in enumerate(WRITES):
        where = register if axis is None else f"{register} of axis {axis}"
        try:
            written = bench.write(name, register, value, axis)
        except ClientError as error:
            return failed(f"{where}: {error}; {index} of {len(WRITES)} registers are written")
        if written.verified is False:  # some registers change by themselves: of those it is None
            return failed(f"{where} holds {written.value} instead of {value}; {index} of {len(WRITES)} are written")
    if MECHANICS:
        set_mechanics(bench, device)
    print(f"{name}: {len(WRITES)} registers written and checked")
    return 0


def set_mechanics(bench: Bench, device: Device) -> None:
    """Tell the server what the motors move; names and soft limits stay as they are."""
    axes = [{key: axis[key] for key in ("name", "limits", *MECHANICS[0])} for axis in device.axes]
    for axis, mechanics in zip(axes, MECHANICS):
        axis.update(mechanics)
    bench.call("PATCH", f"devices/{device.id}", {"axes": axes})


def failed(what: str) -> int:
    """Tell it, and the exit code."""
    print(what, file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
'''


def render(plan: Plan) -> str:
    """The whole file."""
    return "\n".join([_HEAD, *_lines(plan)]) + _BODY


def _lines(plan: Plan) -> Iterator[str]:
    yield f"# Profile: {one_line(plan.name)}"
    yield f"# {plan.about}"
    yield from (f"# {line}".rstrip() for line in (*lines(plan.note), *plan.program_left_out))
    yield ""
    yield "import argparse"
    yield "import sys"
    yield ""
    yield "from stepscope import Bench, ClientError, Device"
    yield ""
    yield f"MODEL = {json.dumps(plan.model)}"
    yield f"DEVICE = {json.dumps(plan.device)}"
    yield f"TARGET = {json.dumps(target_of(plan.model))}"
    busy = ", ".join(f"({_words(each)})" for each in busy_of(plan.model))
    yield f"BUSY: list[tuple[str, int | None, str, str]] = [{busy}]"
    yield "Value = int | dict[str, int]"
    yield "WRITES: list[tuple[str, int | None, Value]] = ["
    for part in plan.parts:
        yield f"    # {one_line(part.title)}"
        for write in part.writes:
            yield _entry(write)
    yield "]"
    yield "MECHANICS: list[dict[str, float | None]] = ["
    yield from (f"    {_literal(mechanics)}," for mechanics in plan.mechanics)
    yield "]"


def _words(busy: Busy) -> str:
    return f"{json.dumps(busy.register)}, {busy.axis!r}, {json.dumps(busy.field)}, {json.dumps(busy.why)}"


def _literal(numbers: Mapping[str, float | None]) -> str:
    return f"{{{', '.join(f'{json.dumps(name)}: {number!r}' for name, number in numbers.items())}}}"


def _entry(write: Write) -> str:
    register = write.register
    head = f"    ({json.dumps(register.name)}, {register.axis!r}, "
    if write.fields:
        fields = (f"{json.dumps(name)}:{GLUE}{value}" for name, value in write.fields.items())
        whole = f"{head}{{{', '.join(fields)}}}),"
        wrapped = textwrap.fill(whole, WIDTH, subsequent_indent=" " * 8, break_long_words=False, break_on_hyphens=False)
        return wrapped.replace(GLUE, " ")
    call = f"{head}{write.number}),"
    said = one_line(meaning(write))
    return call if said == write.number else f"{call:<56} # {said}"
