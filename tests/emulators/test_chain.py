"""The driver chain: DS-TMC428 sections 2.1, 6.3, 9.1 to 9.3, 9.7, chapters 10 and 11."""

from __future__ import annotations

import pytest

from app.emulators.tmc428 import chain
from app.emulators.tmc428.kernel import NEVER
from tests.emulators.harness import (
    CONTINUOUS,
    COVER,
    COVER_DATAGRAM,
    GLOBAL,
    HIGH_WORD,
    HOLD,
    LOW_WORD,
    NO_STOPS,
    SINE,
    TABLE_11_3,
    V_ACTUAL,
    X_TARGET,
    Bench,
    free_bench,
)

NAMES = [
    "Zero",
    *(f"DAC_A_{bit}" for bit in (5, 4, 3, 2)),
    "PH_A",
    "Zero",
    *(f"DAC_B_{bit}" for bit in (5, 4, 3, 2)),
    "PH_B",
]
NAMES_WITH_DECAY = ["FD_A", *NAMES[1:6], "FD_B", *NAMES[7:]]


def chained(parameters: int = 0x702) -> Bench:
    bench = free_bench()
    bench.three_drivers(parameters)
    return bench


def send(bench: Bench) -> str:
    """Force an unchanged datagram and return its bits."""
    bench.write(COVER, 0)
    bench.write(COVER_DATAGRAM, 0)
    bench.seconds(0.01)
    return bench.chain().last_bits


@pytest.mark.sheet("DS-TMC428", "10")
@pytest.mark.sheet("DS-TMC428", "11.2")
def test_table_11_3_writes_the_ram_of_table_11_2() -> None:
    bench = chained()
    first = [0x10, 5, 4, 3, 2, 6, 0x10, 0xD, 0xC, 0xB, 0xA, 0x2E]
    cells = []
    for word in range(18):
        data = bench.read(0x40 | word)
        cells += [data & 0xFF, data >> 8]
    assert cells == [*first, *first, 0x07, *first[1:6], 0x0F, *first[7:]]
    assert len(TABLE_11_3.split()) == 18


@pytest.mark.sheet("DS-TMC428", "11.2")
@pytest.mark.sheet("DS-TMC428", "11")
@pytest.mark.sheet("DS-TMC428", "9.7")
def test_the_example_chain_sends_36_bits_in_order() -> None:
    bench = chained()
    assert len(send(bench)) == 36
    drivers = bench.chain().drivers
    assert [[bit.signal for bit in driver.bits] for driver in drivers] == [NAMES, NAMES, NAMES_WITH_DECAY]
    # Wave index 0: sine 0 positive, cosine full and positive, fast decay on the cosine (full step: both 63).
    assert send(bench) == "0" + "1111" + "1" + "0" + "1111" + "1" + "011111011111" + "0" + "11111" + "1" + "11111"


@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize(("lsmd", "bits"), [(0, 12), (1, 24), (2, 36)])
def test_lsmd_is_the_number_of_drivers_less_one(lsmd: int, bits: int) -> None:
    assert len(send(chained(0x700 | lsmd))) == bits


@pytest.mark.sheet("DS-TMC428", "11")
@pytest.mark.parametrize("code", range(0x20))
def test_every_primary_signal_code(code: int) -> None:
    """A chain of one bit, motor 1 on wave index 64 + 16 (usrs 6): sine entry 48, cosine entry 16, quadrant 2."""
    bench = free_bench()
    bench.three_drivers(0x700)
    bench.ramp(dividers=0x4406)
    bench.write(X_TARGET, 80)
    bench.seconds(0.2)
    bench.write(0x40, 0x20 | code)
    sine, cosine = SINE[48], SINE[16]
    expected = {code: sine >> code & 1 for code in range(6)} | {8 + bit: cosine >> bit & 1 for bit in range(6)}
    expected |= {0x06: 1, 0x07: 1, 0x0E: 0, 0x0F: 0, 0x10: 0, 0x12: 0, 0x13: 0}
    assert send(bench) == str(expected.get(code, 1))


@pytest.mark.sheet("DS-TMC428", "11")
def test_step_and_direction_bits() -> None:
    bench = free_bench()
    bench.three_drivers(0x700)
    bench.write(0x40, 0x13 | 0x32 << 8)
    bench.ramp(dividers=0x8806)
    bench.write(X_TARGET, 1)
    bench.seconds(0.3)
    assert bench.chain().last_bits == "10"  # a step up
    assert send(bench) == "00"  # no step since
    bench.write(X_TARGET, 0)
    bench.seconds(0.3)
    assert bench.chain().last_bits == "11"
    assert bench.chain().datagrams_sent == 3


@pytest.mark.sheet("DS-TMC428", "2.4")
@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.sheet("DS-TMC428", "12.1")
@pytest.mark.parametrize(
    ("bit", "codes"), [(4, (0x06, 0x0E)), (5, (0x07, 0x0F)), (6, tuple(range(6)) + tuple(range(8, 14)))]
)
def test_polarity_bits_invert_their_signals(bit: int, codes: tuple[int, ...]) -> None:
    for code in range(0x14):
        plain, inverted = free_bench(), free_bench()
        levels = []
        for bench, parameters in ((plain, 0x700), (inverted, 0x700 | 1 << bit)):
            bench.three_drivers(parameters)
            bench.write(0x40, 0x20 | code)
            levels.append(send(bench))
        assert (levels[0] != levels[1]) == (code in codes), code


@pytest.mark.sheet("DS-TMC428", "9.7")
def test_inverting_the_phase_bits_turns_the_motor_round() -> None:
    bench = chained(0x702 | 1 << 4)
    bench.ramp()
    start = bench.place()
    bench.write(X_TARGET, 640)
    bench.seconds(0.1)
    assert (bench.x, bench.place() - start) == (640, -10)


@pytest.mark.sheet("DS-TMC428", "11")
def test_without_an_nxm_bit_the_datagram_never_ends_until_one_is_written() -> None:
    bench = free_bench()
    for word in range(32):
        bench.write(0x40 | word, 0x1010)
    bench.ramp()
    bench.write(X_TARGET, 500)
    bench.write(COVER_DATAGRAM, 1)
    bench.seconds(1.0)
    state = bench.chain()
    assert (bench.x, state.endless, state.busy, state.datagrams_sent) == (500, True, True, 1)
    bench.read(0)
    assert bench.status & 0x40
    bench.write(0x40, 0x30)
    bench.seconds(0.01)
    state = bench.chain()
    assert (state.endless, state.busy) == (False, False)
    assert state.datagrams_sent == 2  # what was asked for meanwhile
    bench.read(0)
    assert not bench.status & 0x40


@pytest.mark.sheet("DS-TMC428", "7.2")
@pytest.mark.sheet("DS-TMC428", "11")
@pytest.mark.sheet("DS-TMC428", "9.7")
def test_datagrams_are_sent_on_demand_only() -> None:
    bench = chained()
    bench.seconds(1.0)
    assert bench.chain().datagrams_sent == 0
    bench.ramp(dividers=0x6606)
    bench.write(X_TARGET, 25)
    bench.seconds(1.0)
    assert bench.chain().datagrams_sent == 25
    bench.seconds(1.0)
    assert bench.chain().datagrams_sent == 25


@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize("ramp_divs", [(0, 0, 0), (5, 5, 5), (4, 5, 7), (2, 9, 9)])
def test_continuous_update_frequency(ramp_divs: tuple[int, int, int]) -> None:
    """f = fCLK * (1/2^rd0 + 1/2^rd1 + 1/2^rd2) / 32768, all motors at rest."""
    bench = chained(CONTINUOUS | 0x702)
    for axis, ramp_div in enumerate(ramp_divs):
        bench.write(axis << 4 | 0xC, ramp_div << 8)
    before = bench.chain().datagrams_sent
    bench.seconds(5.0)
    expected = 16e6 * sum(2.0**-ramp_div for ramp_div in ramp_divs) / 32768 * 5
    assert bench.chain().datagrams_sent - before == pytest.approx(expected, rel=0.002, abs=3)


@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.sheet("DS-TMC428", "6.3")
@pytest.mark.parametrize(
    ("clk2_div", "clocks"),
    [(7, 41 * 16), (0, 41 * 16), (6, 41 * 16), (8, 42.5 * 18), (15, 42.5 * 32), (255, 42.5 * 512)],
)
def test_datagram_duration(clk2_div: int, clocks: float) -> None:
    """Three drivers of 12 bits: 1 + 3 * (12 + 1) + 1 SPI clocks, with 1.5 for each NxM above clk2_div 7."""
    bench = chained(clk2_div << 8 | 2)
    duration_us = bench.chain().duration_us
    assert duration_us is not None
    assert duration_us * 16 == pytest.approx(clocks)
    bench.write(COVER_DATAGRAM, 0)
    bench.clocks(clocks - 1)
    assert bench.chain().busy
    bench.clocks(1)
    assert not bench.chain().busy


@pytest.mark.sheet("DS-TMC428", "2.1")
@pytest.mark.sheet("DS-TMC428", "9.7")
def test_steps_faster_than_datagrams_are_not_all_seen_by_the_drivers() -> None:
    bench = chained()
    bench.ramp(mode=HOLD)
    bench.write(V_ACTUAL, 2047)
    bench.seconds(0.1)
    assert bench.x == pytest.approx(50_000, rel=0.001)
    assert bench.chain().datagrams_sent == pytest.approx(0.1 * 16e6 / 656, rel=0.001)


@pytest.mark.sheet("DS-TMC428", "11")
def test_an_early_nxm_wraps_round_the_ram() -> None:
    ram = [0x10] * 64
    ram[5] |= 0x20
    places = chain.walk(ram, 1)
    assert places is not None
    assert len(places) == 6 + 64
    assert [place.driver for place in places] == [0] * 6 + [1] * 64
    assert chain.walk([0x1F] * 64, 0) is None
    assert chain.duration_clocks(None, 7) == NEVER


@pytest.mark.sheet("DS-TMC428", "9.2")
@pytest.mark.sheet("DS-TMC428", "9.3")
@pytest.mark.parametrize("position", [0, 5, 39, 62])
def test_cover_position_reads_back_plus_one(position: int) -> None:
    bench = chained()
    assert bench.read(COVER) == 0
    bench.write(COVER, position << 8 | 7)
    assert bench.read(COVER) == position + 1 << 8 | 7


@pytest.mark.sheet("DS-TMC428", "9.2")
@pytest.mark.sheet("DS-TMC428", "9.3")
def test_a_cover_datagram_covers_the_next_datagram_and_only_that() -> None:
    bench = chained()
    plain = send(bench)
    bench.write(COVER, 14 << 8 | 7)
    bench.write(COVER_DATAGRAM, 0b0101101)
    bench.seconds(0.001)
    assert bench.chain().last_bits == plain[:14] + "0101101" + plain[21:]
    assert bench.chain().covered
    bench.ramp(dividers=0x6600)
    bench.write(X_TARGET, 4)
    bench.seconds(0.5)
    assert bench.chain().last_bits == plain


@pytest.mark.sheet("DS-TMC428", "9.3")
def test_cdgw_until_the_cover_datagram_is_sent() -> None:
    bench = chained()
    bench.write(COVER, 3)
    bench.write(COVER_DATAGRAM, 5)
    assert bench.read(COVER) >> 23 == 1
    assert bench.status & 0x40
    bench.clocks(655)
    bench.read(0)
    assert bench.status & 0x40
    bench.clocks(1)
    assert bench.read(COVER) >> 23 == 0
    assert not bench.status & 0x40


@pytest.mark.sheet("DS-TMC428", "9.3")
def test_a_cover_written_during_a_datagram_waits_for_the_next() -> None:
    bench = chained()
    plain = send(bench)
    count = bench.chain().datagrams_sent
    bench.write(COVER_DATAGRAM, 0)
    bench.clocks(100)
    bench.write(COVER, 24)
    bench.write(COVER_DATAGRAM, 0xABCDEF)
    bench.clocks(656)
    bench.read(0)
    assert bench.status & 0x40
    bench.clocks(656)
    bench.read(0)
    assert not bench.status & 0x40
    state = bench.chain()
    assert state.datagrams_sent == count + 2
    assert state.last_bits == f"{0xABCDEF:024b}" + plain[24:]


@pytest.mark.sheet("DS-TMC428", "9.3")
def test_length_zero_forces_an_unchanged_datagram() -> None:
    bench = chained()
    before = bench.chain().datagrams_sent
    bits = send(bench)
    assert bench.chain().datagrams_sent == before + 1
    assert bits == send(bench)


@pytest.mark.sheet("DS-TMC428", "9.1")
@pytest.mark.sheet("DS-TMC428", "2")
def test_reply_words_capture_the_next_datagram_after_a_write() -> None:
    bench = chained()
    bench.patch(drivers=[{"axis": 0, "status": 0x123}, {"axis": 1, "status": 0x456}, {"axis": 2, "status": 0x789}])
    bench.ramp(dividers=0x6606)
    bench.write(X_TARGET, 1)
    bench.seconds(0.1)
    assert (bench.read(LOW_WORD), bench.read(HIGH_WORD)) == (0, 0)  # nobody asked
    bench.write(LOW_WORD, 0)
    bench.read(0)
    assert bench.status & 0x40
    bench.seconds(0.1)
    bench.read(0)
    assert bench.status & 0x40  # no datagram was sent meanwhile
    bench.write(X_TARGET, 2)
    bench.seconds(0.1)
    assert (bench.read(LOW_WORD), bench.read(HIGH_WORD)) == (0x456789, 0x123)
    assert not bench.status & 0x40
    bench.patch(drivers=[{"axis": 0, "status": 0x0FF}])
    bench.write(X_TARGET, 3)
    bench.seconds(0.1)
    assert bench.read(HIGH_WORD) == 0x123  # held until armed again
    bench.write(HIGH_WORD, 0)
    assert bench.read(HIGH_WORD) == 0
    bench.write(X_TARGET, 4)
    bench.seconds(0.1)
    assert bench.read(HIGH_WORD) == 0x0FF


@pytest.mark.sheet("DS-TMC428", "9.1")
@pytest.mark.sheet("DS-TMC428", "9.3")
def test_a_cover_datagram_updates_the_reply_words_by_shifting() -> None:
    bench = chained()
    send(bench)
    assert (bench.read(LOW_WORD), bench.read(HIGH_WORD)) == (0x100100, 0x100)
    send(bench)
    assert (bench.read(LOW_WORD), bench.read(HIGH_WORD)) == (0x100100, 0x100100)


@pytest.mark.sheet("DS-TMC428", "9.1")
def test_longer_datagrams_leave_their_last_48_bits() -> None:
    statuses = [0xABC, 0xDEF, 0x123]
    sent = [1, 0] * 30
    back = chain.reply_bits(sent, statuses)
    assert "".join(map(str, back)) == f"{0xABCDEF123:036b}" + "10" * 12


@pytest.mark.sheet("DS-TMC428", "11.2")
def test_the_chain_may_be_reconfigured_at_any_time() -> None:
    bench = chained()
    bench.ramp(dividers=0x3306)
    bench.write(X_TARGET, 50_000)
    bench.seconds(0.05)
    bench.hex("80000507")  # fast decay for driver 1, in motion
    bench.seconds(0.05)
    assert bench.chain().drivers[0].bits[0].signal == "FD_A"
    assert bench.v > 0


@pytest.mark.sheet("DS-TMC428", "11.1")
def test_datagrams_before_the_ram_is_initialised_are_random_but_harmless() -> None:
    for seed in range(20):
        bench = free_bench(seed=seed)
        bench.ramp(flags=NO_STOPS)
        bench.write(X_TARGET, 300)
        bench.seconds(0.1)
        assert bench.x == 300
        assert bench.chain().datagrams_sent > 0


@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize("polarity", [0, 1])
def test_the_chip_select_polarity_also_turns_the_multiplexer(polarity: int) -> None:
    """nSCS_S drives the 74HC157 (Figure 9-5): the other level at rest shows the other switches."""
    bench = Bench()
    bench.three_drivers(0x702 | polarity << 2)
    bench.switch(left=True, right=False)
    assert bench.read(0x3E) >> 1 & 1 == (not polarity)
    bench.write(GLOBAL, 1 << 20 | 0x702 | polarity << 2)
    send(bench)
    assert bench.read(0x3E) & 3 == (0b01 if polarity else 0b10)
