"""RAMP_STAT, GSTAT and ENC_STATUS: cleared by reading in the TMC5031 to TMC5130, by writing ones in the TMC5160.

Which bits of RAMP_STAT latch is inferred (NOTES-TMC5XXX 5): latches, StallGuard2's stop, position reached and second
move; stops by switches are told while they hold.
"""

from __future__ import annotations

import pytest

from app.emulators.tmc5xxx import MODELS, Tmc5xxxModel
from app.links.datagram40 import read
from tests.emulators.tmc5xxx.rig import DUAL, PLACES, SINGLE, TURN, Bench, moving

BY_READING: tuple[Tmc5xxxModel, ...] = ("tmc5031", "tmc5062", "tmc5072", "tmc5130")
LATCHING = {"status_latch_l", "status_latch_r", "event_stop_sg", "event_pos_reached", "second_move"}


def latched(model: Tmc5xxxModel, axis: int = 0) -> Bench:
    """A chip with the left latch, position reached and second move set."""
    bench = moving(model, axis)
    bench.put(axis, SW_MODE=1 << 5, XTARGET=TURN)
    bench.wait(0.3)
    bench.put(axis, XTARGET=-TURN)
    bench.stage(axis, switches={"left": True})
    bench.wait(3)
    return bench


WANTED = {"status_latch_l", "event_pos_reached", "second_move"}


@pytest.mark.parametrize(("model", "axis"), [place for place in PLACES if place[0] in BY_READING])
def test_reading_clears_what_latches_and_nothing_else(model: Tmc5xxxModel, axis: int) -> None:
    bench = latched(model, axis)
    bench.write("RAMP_STAT", 0xFFFFFFFF, axis)
    first, second = bench.flags(axis), bench.flags(axis)
    assert first >= WANTED
    assert first - second == WANTED
    assert {"position_reached", "vzero", "status_stop_l"} <= second


def test_writing_ones_clears_them_in_a_tmc5160() -> None:
    bench = latched("tmc5160")
    assert bench.flags() >= WANTED
    assert bench.flags() >= WANTED
    bench.write("RAMP_STAT", 1 << 2)
    assert bench.flags() & LATCHING == WANTED - {"status_latch_l"}
    bench.write("RAMP_STAT", 0x3FFF)
    assert not bench.flags() & LATCHING
    assert {"position_reached", "vzero", "status_stop_l"} <= bench.flags()


@pytest.mark.parametrize("model", BY_READING)
def test_a_read_over_spi_clears_although_its_answer_comes_later(model: Tmc5xxxModel) -> None:
    bench = latched(model)
    bench.chip.exchange(read(0x35), bench.now_s)
    bench.chip.exchange(read(0x35), bench.now_s)
    told = bench.table.get("RAMP_STAT", 0).unpack(
        int.from_bytes(bench.chip.exchange(read(0x22), bench.now_s)[1:], "big")
    )
    assert told["event_pos_reached"] == 0


@pytest.mark.parametrize("model", MODELS)
def test_gstat_tells_a_reset_once(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    assert bench.field("GSTAT", "reset") == 1
    if model in ("tmc5160", "tmc5240"):
        bench.write("GSTAT", 0)
        assert bench.field("GSTAT", "reset") == 1
        bench.write("GSTAT", 1 if model == "tmc5160" else 1 | 1 << 3)
    assert bench.raw("GSTAT") == 0
    bench.patch(power_cycle=True)
    assert bench.field("GSTAT", "reset") == 1


@pytest.mark.parametrize("model", MODELS)
def test_gstat_tells_errors_of_the_drivers(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    bench.write("GSTAT", bench.raw("GSTAT"))
    bench.stage(motor={"temperature_c": 155})
    assert bench.field("GSTAT", "drv_err" if model in SINGLE else "drv_err1") == 1
    bench.write("GSTAT", bench.raw("GSTAT"))
    bench.patch(supply_v=4.0)
    assert bench.field("GSTAT", "uv_cp") == 1
    bench.write("GSTAT", bench.raw("GSTAT"))
    assert bench.field("GSTAT", "uv_cp") == 1, "it stays as long as the cause does"
    bench.patch(supply_v=24.0)
    bench.write("GSTAT", bench.raw("GSTAT"))
    assert bench.raw("GSTAT") == 0


@pytest.mark.parametrize("model", DUAL)
def test_gstat_tells_which_driver(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    bench.raw("GSTAT")
    bench.stage(1, motor={"temperature_c": 155})
    assert bench.raw("GSTAT") == 1 << 2
    assert bench.raw("GSTAT") == 0


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_the_interrupt_output_follows_the_events(model: Tmc5xxxModel, axis: int) -> None:
    bench = moving(model, axis)
    bench.clear(axis)
    if bench.table.find("ENC_STATUS", axis):
        bench.put(axis, ENCMODE=1 << 2 | 1 << 6)
        bench.write("ENC_STATUS", bench.raw("ENC_STATUS", axis), axis)
        if model in DUAL:
            other = 1 - axis
            bench.put(other, ENCMODE=1 << 2 | 1 << 6)
            bench.raw("ENC_STATUS", other)
    bench.put(axis, XTARGET=100)
    assert not bench.state().pins.interrupt
    bench.wait(1)
    assert bench.state().pins.interrupt
    bench.clear(axis)
    assert not bench.state().pins.interrupt
