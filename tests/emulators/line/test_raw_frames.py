"""A chip's raw frames on a serial port: `stepscope emulate tmc4361 --pty`."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
import serial

from app.clock import VirtualClock
from app.emulators.line.framing import Fixed
from app.emulators.line.line import Line
from app.emulators.line.raw import RawChip
from app.emulators.tmc4361 import EmulatedTmc4361, Tmc4361Patch
from app.links import datagram40
from tests.peers.emulator_process import emulator


def line_with_chip(baud: int | None = None) -> tuple[Line, EmulatedTmc4361]:
    clock = VirtualClock()
    chip = EmulatedTmc4361(clock)
    line = Line([RawChip(chip)], clock, baud=baud, framing=Fixed(5))
    line.join("client")
    return line, chip


def test_five_bytes_are_a_frame_and_take_their_time() -> None:
    line, _ = line_with_chip(baud=10_000)
    line.feed("client", datagram40.write(0x32, 7) + datagram40.FETCH, 0.0)
    assert line.collect(0.0099) == []
    first, second = line.collect(1.0)
    assert first.due_s == pytest.approx(0.010), "five bytes there, five back, a millisecond each"
    assert second.due_s == pytest.approx(0.020)
    assert second.data[1:] == (7).to_bytes(4, "big")


def test_bytes_that_a_module_would_take_for_a_wish_for_events_are_data_here() -> None:
    line, _ = line_with_chip()
    line.feed("client", bytes((0x32, 138, 100, 0, 0)) * 2, 0.0)
    assert len(line.collect(0.0)) == 2
    assert line.next_due_s() is None


def test_a_silent_chip_says_nothing_and_goes_on() -> None:
    line, chip = line_with_chip()
    chip.patch(Tmc4361Patch.model_validate({"faults": {"silence": True}}))
    line.feed("client", datagram40.write(0x32, 9), 0.0)
    assert line.collect(1.0) == []
    chip.patch(Tmc4361Patch.model_validate({"faults": {"silence": False}}))
    line.feed("client", datagram40.FETCH, 1.0)
    ((_, _, reply),) = line.collect(1.0)
    assert reply[1:] == (9).to_bytes(4, "big")


def test_in_a_process_of_its_own(tmp_path: Path) -> None:
    with emulator(pty=tmp_path / "chip", model="tmc4361") as process:
        with serial.Serial(os.fspath(tmp_path / "chip"), 115200, timeout=20) as port:
            port.write(datagram40.write(0x32, 0xDEAD_BEEF) + datagram40.FETCH)
            assert port.read(10)[6:].hex() == "deadbeef"
        assert process.end(signal.SIGINT) == 0
        assert not (tmp_path / "chip").is_symlink()
