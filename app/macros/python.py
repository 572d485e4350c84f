"""A macro as a Python program for stepscope's client."""

from __future__ import annotations

import json
from collections.abc import Iterator

from .document import (
    ApplyProfile,
    MacroDocument,
    MoveStep,
    RecordStart,
    RecordStop,
    RotateStep,
    Step,
    StopStep,
    WaitChannel,
    WaitPosition,
    WaitStep,
    WriteStep,
)

# Nothing that people wrote may stand in the first two lines: there a remark can name another encoding of the file.
_HEAD = '''\
#!/usr/bin/env python3
"""Do the steps of a stepscope macro, one after the other, through a running server.

Needs the stepscope package. The server is --url, else STEPSCOPE_URL; one that asks for a token finds it in
STEPSCOPE_TOKEN. A step that fails ends it, and so does Ctrl-C: then the motors that it moved are stopped.
"""

import argparse
import sys
import time

from stepscope import Bench, ClientError

'''
_TAIL = '''

def wait_position(bench: Bench, device: str, axis: int, at_most_s: float) -> None:
    """Until the axis is where it was sent."""
    until_s = time.monotonic() + at_most_s
    while True:
        state = bench.axis(device, axis)
        if state.position_reached and not state.moving:
            return
        if time.monotonic() > until_s:
            raise ClientError(f"axis {axis} is at {state.position} after {at_most_s} s, not {state.target_position}")
        time.sleep(0.05)


def wait_channel(bench: Bench, device: str, channel: str, when: str, value: float, at_most_s: float) -> None:
    """Until a channel is "above" or "below" a value."""
    until_s = time.monotonic() + at_most_s
    while True:
        seen = bench.watch(device, [channel], 0.05)[channel]
        if any(sample > value if when == "above" else sample < value for sample in seen):
            return
        if time.monotonic() > until_s:
            raise ClientError(f"{channel} was not {when} {value} within {at_most_s} s")


def main() -> int:
    """Take the bench, and do all steps; the exit code is 0 when all are done."""
    parser = argparse.ArgumentParser(description="Do the steps of a stepscope macro.")
    parser.add_argument("--url", help="the server, e.g. http://127.0.0.1:8000 [default: STEPSCOPE_URL]")
    parser.add_argument("--device", default=DEVICE, help="id of the device [default: %(default)s]")
    arguments = parser.parse_args()
    try:
        with Bench(arguments.url) as bench, bench.lease(f"macro {NAME}"[:60]):
            try:
                steps(bench, arguments.device)
            except BaseException:
                for axis in AXES:
                    bench.stop(arguments.device, axis)
                raise
    except ClientError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
'''


def render(document: MacroDocument, device: str) -> str:
    """The whole file."""
    moved = sorted({step.axis for step in document.steps if isinstance(step, MoveStep | RotateStep)})
    lines = [
        f"NAME = {json.dumps(document.name)}",
        f"DEVICE = {json.dumps(device)}",
        f"AXES = {moved!r}",
        "",
        "",
        "def steps(bench: Bench, device: str) -> None:",
        '    """The macro."""',
        *(f"    {line}" for step in document.steps for line in _lines(step)),
    ]
    if not document.steps:
        lines.append("    del bench, device  # it has none")
    turns = [step for step in document.steps if isinstance(step, RecordStart | RecordStop)]
    if turns and isinstance(turns[-1], RecordStart):
        lines.append("    bench.stop_recording(recording.id)")
    return _HEAD + "\n".join(lines) + "\n" + _TAIL


def _lines(step: Step) -> Iterator[str]:
    match step:
        case WriteStep():
            value = repr(step.value) if step.fields is None else json.dumps(step.fields)
            yield f"bench.write(device, {json.dumps(step.name)}, {value}, {step.axis!r})"
        case MoveStep():
            how = f"relative={step.relative!r}, unit={json.dumps(step.unit)}, wait=False"
            yield f"bench.move(device, {step.axis}, {step.target!r}, {how})"
        case RotateStep():
            yield f"bench.rotate(device, {step.axis}, {step.velocity!r}, unit={json.dumps(step.unit)})"
        case StopStep():
            yield f"bench.stop(device, {step.axis}, {json.dumps(step.mode)})"
        case WaitStep():
            yield f"time.sleep({step.seconds!r})"
        case WaitPosition():
            yield f"wait_position(bench, device, {step.axis}, {step.at_most_s!r})"
        case WaitChannel():
            what = f"{json.dumps(step.channel)}, {json.dumps(step.when)}, {step.value!r}, {step.at_most_s!r}"
            yield f"wait_channel(bench, device, {what})"
        case RecordStart():
            what = f"{json.dumps(step.channels)}, {step.rate_hz!r}, name={json.dumps(step.name)}"
            yield f"recording = bench.record(device, {what})"
        case RecordStop():
            yield "bench.stop_recording(recording.id)"
        case ApplyProfile():
            yield f"bench.apply_profile(device, bench.saved_profile({step.profile}))"
