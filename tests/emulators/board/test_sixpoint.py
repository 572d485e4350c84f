"""A TMC5xxx in the slot of the emulated board: what of each command reaches its registers."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from app.clock import VirtualClock
from app.emulators.board.board import EmulatedBoard
from app.emulators.board.build import build_board
from app.emulators.board.options import BoardPatch
from app.emulators.board.sixpoint import BOARD_IDS
from app.emulators.tmc5xxx import MODELS, EmulatedTmc5xxx, Tmc5xxxModel
from app.errors import UsageError
from app.links.datagram40 import Request as Datagram
from app.links.tmcl import Reply, Request
from app.registers.catalog import MODELS as CATALOG
from app.registers.evaluation_board import CHANNEL_1_BOARDS, BoardOpcode
from app.registers.tmcl.commands import Opcode, Status

RAMPMODE, XACTUAL, VMAX, XTARGET, AMAX, DMAX, D1, SW_MODE, RAMP_STAT = (
    0x20,
    0x21,
    0x27,
    0x2D,
    0x26,
    0x28,
    0x2A,
    0x34,
    0x35,
)
CHOPCONF, COOLCONF = 0x6C, 0x6D
DUAL: tuple[Tmc5xxxModel, ...] = ("tmc5031", "tmc5062", "tmc5072")
SINGLE: tuple[Tmc5xxxModel, ...] = ("tmc5130", "tmc5160", "tmc5240")


class WatchedChip(EmulatedTmc5xxx):
    """The emulated chip itself, with a look at its bus."""

    def __init__(self, model: Tmc5xxxModel, clock: VirtualClock) -> None:
        super().__init__(model, clock)
        self.heard: list[Datagram] = []

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        self.heard.append(Datagram.decode(frame))
        return super().exchange(frame, at_s)


class Bench:
    def __init__(self, model: Tmc5xxxModel) -> None:
        self.clock = VirtualClock()
        self.chip = WatchedChip(model, self.clock)
        self.board = EmulatedBoard(self.chip)

    def ask(self, opcode: int, type_: int = 0, motor: int = 0, value: int = 0) -> Reply:
        frame = self.board.receive(Request(1, opcode, type_, motor, value).encode())
        assert frame is not None
        return Reply.decode(frame)

    def read(self, address: int) -> int:
        return self.ask(BoardOpcode.READ_MC, address).value

    def set(self, number: int, value: int, motor: int = 0) -> int:
        return self.ask(Opcode.SAP, number, motor, value).status

    def get(self, number: int, motor: int = 0) -> int:
        reply = self.ask(Opcode.GAP, number, motor)
        assert reply.ok, reply
        return reply.value

    def writes(self, act: Callable[[], object]) -> list[tuple[int, int]]:
        """What is written over the chip's bus while `act` is done."""
        self.chip.heard.clear()
        act()
        return [(datagram.address, datagram.data) for datagram in self.chip.heard if datagram.write]


@pytest.fixture(params=MODELS)
def bench(request: pytest.FixtureRequest) -> Bench:
    return Bench(request.param)


def test_every_board_is_known_by_its_number() -> None:
    for model in MODELS:
        assert CHANNEL_1_BOARDS[BOARD_IDS[model]] == CATALOG[model].board == model.upper()
        assert isinstance(build_board(model, VirtualClock(), {"clock_hz": 12e6}).chip, EmulatedTmc5xxx)


def test_who_it_is(bench: Bench) -> None:
    number = BOARD_IDS[bench.chip.model]
    assert bench.ask(Opcode.GGP, 4).value == 0x0400_0200 | number, "nothing in the other slot"
    assert bench.ask(BoardOpcode.GET_INFO, 201).value == number << 16
    assert bench.ask(Opcode.GET_VERSION, 6).value == len(bench.chip.state().axes)
    assert bench.ask(Opcode.ROR, 0, len(bench.chip.state().axes), 5).status == Status.WRONG_TYPE


# --- setting up -----------------------------------------------------------------------------------


def test_after_power_on_the_chip_is_set_up(bench: Bench) -> None:
    chopconf = 0x0041_0153 if bench.chip.model in ("tmc5160", "tmc5240") else 0x0001_01D5
    assert bench.read(CHOPCONF) == chopconf
    assert bench.read(0x60) & 0xFFFF_FFFF == 0xAAAA_B554, "the sine of the chip, from the firmware's memory"
    if bench.chip.model == "tmc5160":
        assert (bench.read(0), bench.read(0x2B), bench.read(0x10)) == (8, 1, 0x0007_0A03)


def test_a_reset_writes_presets_and_zeros_and_leaves_the_tables_alone(bench: Bench) -> None:
    bench.ask(BoardOpcode.WRITE_MC, AMAX, 0, 5)
    written = dict(bench.writes(lambda: bench.ask(BoardOpcode.BOARD_RESET)))
    assert (written[AMAX], written[VMAX], written[RAMPMODE]) == (0, 0, 0)
    assert not set(range(0x60, 0x6A)) & written.keys()
    assert (0x70 in written) is False, "PWMCONF, or the second table"
    assert bench.read(AMAX) == 0
    if bench.chip.model == "tmc5072":
        assert (written[0x10], written[0x18]) == (0x0005_04C8, 0x0005_04C8)


def test_a_motor_that_turns_is_not_reset(bench: Bench) -> None:
    bench.set(5, 50_000)
    bench.ask(Opcode.ROR, 0, 0, 100_000)
    bench.clock.set(0.1)
    assert bench.writes(lambda: bench.ask(BoardOpcode.BOARD_RESET)) == []
    assert bench.get(3) > 0


def test_a_power_cycle_forgets_everything(bench: Bench) -> None:
    bench.ask(BoardOpcode.WRITE_MC, XTARGET, 0, 77)
    bench.board.patch(BoardPatch(power_cycle=True))
    assert bench.read(XTARGET) == 0


# --- motion by TMCL -------------------------------------------------------------------------------


def test_commands_become_writes_of_registers(bench: Bench) -> None:
    assert bench.writes(lambda: bench.ask(Opcode.ROR, 0, 0, 1000)) == [(VMAX, 1000), (RAMPMODE, 1)]
    assert bench.writes(lambda: bench.ask(Opcode.ROL, 0, 0, 1000)) == [(VMAX, 1000), (RAMPMODE, 2)]
    assert bench.writes(lambda: bench.ask(Opcode.MST)) == [(VMAX, 0), (RAMPMODE, 1)]
    bench.set(4, 7000)
    by_parameter_4 = [(RAMPMODE, 0), (VMAX, 7000), (XTARGET, 0xFFFF_FFFB)]
    as_before = [(VMAX, 1000), (XTARGET, 0xFFFF_FFFB), (RAMPMODE, 0)]  # at the first rotation it was 0, which is none
    wanted = as_before if bench.chip.model == "tmc5062" else by_parameter_4
    assert bench.writes(lambda: bench.ask(Opcode.MVP, 0, 0, -5)) == wanted


@pytest.mark.parametrize("model", DUAL)
def test_the_second_motor_has_registers_of_its_own(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    assert bench.writes(lambda: bench.ask(Opcode.ROR, 0, 1, 1000)) == [(VMAX + 0x20, 1000), (RAMPMODE + 0x20, 1)]
    bench.set(167, 3, motor=1)
    assert bench.read(0x7C) & 0xF == 3
    assert bench.read(CHOPCONF) & 0xF == 5


def test_it_gets_there(bench: Bench) -> None:
    for number, value in ((5, 50_000), (17, 50_000), (18, 50_000), (20, 10)):
        assert bench.set(number, value) == Status.OK
    bench.set(4, 500_000)
    bench.ask(Opcode.MVP, 0, 0, 2000)
    assert bench.get(8) == 0
    bench.clock.set(2.0)
    assert (bench.get(8), bench.get(1), bench.get(3)) == (1, 2000, 0)
    bench.set(1, 100)
    assert bench.ask(Opcode.MVP, 1, 0, -150).value == -50
    bench.clock.set(4.0)
    assert bench.get(1) == -50


def test_the_velocity_of_positioning_counts_at_once_while_positioning(bench: Bench) -> None:
    bench.ask(Opcode.ROR, 0, 0, 10)
    bench.set(4, -900)
    assert bench.read(VMAX) == 10
    bench.ask(Opcode.MVP, 0, 0, 0)
    if bench.chip.model != "tmc5062":
        assert bench.read(VMAX) == 900
    bench.set(4, 500)
    assert (bench.read(VMAX), bench.get(4)) == (500, 500)


# --- axis parameters ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("number", "value", "address", "word"),
    [
        (0, -7, XTARGET, -7), (1, 7, XACTUAL, 7), (2, -100, VMAX, 100), (5, 1000, AMAX, 1000), (14, 3, SW_MODE, 3),
        (15, 4, 0x24, 4), (16, 5, 0x25, 5), (17, 6, DMAX, 6), (18, 8, D1, 8), (19, 9, 0x23, 9), (20, 12, 0x2B, 12),
        (21, 13, 0x2C, 13),
    ],
)  # fmt: skip
def test_parameters_that_are_registers(bench: Bench, number: int, value: int, address: int, word: int) -> None:
    assert bench.set(number, value) == Status.OK
    assert bench.read(address) == word
    assert bench.get(number) == word


@pytest.mark.parametrize(
    ("number", "value", "address", "shift"),
    [(162, 2, CHOPCONF, 15), (163, 1, CHOPCONF, 14), (167, 9, CHOPCONF, 0), (168, 1, COOLCONF, 15),
     (169, 3, COOLCONF, 13), (170, 5, COOLCONF, 8), (171, 2, COOLCONF, 5), (172, 7, COOLCONF, 0),
     (173, 1, COOLCONF, 24)],
)  # fmt: skip
def test_parameters_that_are_fields(bench: Bench, number: int, value: int, address: int, shift: int) -> None:
    if (bench.chip.model, number) == ("tmc5240", 173):
        address, shift = 0x74, 8  # StallGuard4's filter
    if (bench.chip.model, number) == ("tmc5072", 163):
        shift = 13  # its firmware turns RNDTF by this number
    before = bench.read(address)
    assert bench.set(number, value) == Status.OK
    width = 4 if number in (167, 170, 172) else 2 if number in (162, 169, 171) else 1
    mask = (1 << width) - 1 << shift
    assert bench.read(address) == before & ~mask | value << shift, "and no other bit has changed"
    assert bench.get(number) == value


def test_a_signed_field(bench: Bench) -> None:
    number = 176 if bench.chip.model == "tmc5240" else 174
    bench.set(number, -20)
    assert bench.get(number) == -20
    assert bench.read(COOLCONF) >> 16 & 0x7F == -20 & 0x7F


def test_switches_read_and_switch_on_as_each_board_has_it(bench: Bench) -> None:
    model = bench.chip.model
    assert bench.get(10) == bench.get(11) == (0 if model == "tmc5072" else 1), "nobody presses them"
    on = 0 if model in ("tmc5031", "tmc5130") else 1
    bench.set(12, on)
    assert bench.read(SW_MODE) == 2
    bench.set(12, 1 - on)
    bench.set(13, on)
    assert (bench.read(SW_MODE), bench.get(12), bench.get(13)) == (1, 0, 1)


@pytest.mark.parametrize("model", SINGLE)
def test_thresholds_are_velocities_here_and_times_there(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    bench.set(182, 16_777)
    assert bench.read(0x14) == 1000
    assert bench.get(182) == 16_777
    bench.set(181, 0)
    assert (bench.get(181), bench.read(SW_MODE) >> 10 & 1) == (0, 0)
    bench.set(181, 16_777)
    assert (bench.get(181), bench.read(SW_MODE) >> 10 & 1) == (16_777, 1)


@pytest.mark.parametrize("model", DUAL)
def test_thresholds_of_chips_with_two_axes_are_velocities(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    bench.set(182, 16_777, motor=1)
    assert bench.read(0x51) == bench.get(22, motor=1) == 16_777


@pytest.mark.parametrize("model", ["tmc5062", "tmc5072", *SINGLE])
def test_microsteps(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    for power in range(9):
        assert bench.set(140, 1 << power) == Status.OK
        assert bench.read(CHOPCONF) >> 24 & 0xF == 8 - power
        assert bench.get(140) == (1 << power if model != "tmc5072" else 256 >> 5), "the latter shows TOFF"
    chopconf = bench.read(CHOPCONF)
    for wrong in (0, 3, 512, -1):
        assert bench.set(140, wrong) == (Status.INVALID_VALUE if model in SINGLE else Status.OK)
        assert bench.read(CHOPCONF) == chopconf


def test_the_board_of_the_tmc5031_has_the_resolution_in_another_register() -> None:
    bench = Bench("tmc5031")
    bench.set(140, 16)
    assert bench.read(COOLCONF) >> 24 & 0xF == 4
    assert bench.get(140) == 16


ALWAYS = {*range(9), *range(10, 22), 24, 28, 29, 140, *range(162, 175), 180, 181, 182, 184, 206, 209, 210}
ANSWERED = {
    "tmc5031": ALWAYS | {22, 23, 179, 185, 211},
    "tmc5062": ALWAYS | {22, 23, 179, 185, 211},
    "tmc5072": ALWAYS | {22, 23, 179, 211},
    "tmc5130": ALWAYS | {9, 23, 27, 30, 33, 34, 179, 185, 186, 187, 188, 191, 192, 204},
    "tmc5160": ALWAYS | {23, 27, 33, 34, 35, 185, 186, 187, 188, 191, 192, 204},
    "tmc5240": ALWAYS
    | {22, 23, *range(25, 28), 30, 34, 35, 175, 176, *range(185, 189), *range(191, 197), 204, *range(211, 224)},
}
"""The numbers in each board's list of parameters."""


def test_each_board_answers_the_numbers_of_its_firmware_and_no_others(bench: Bench) -> None:
    for axis in range(len(bench.chip.state().axes)):
        answered = {number for number in range(256) if bench.ask(Opcode.GAP, number, axis).ok}
        assert answered == ANSWERED[bench.chip.model]
    for number in set(range(256)) - ANSWERED[bench.chip.model]:
        assert bench.ask(Opcode.GAP, number).status == bench.set(number, 1) == Status.WRONG_TYPE


def test_the_reference_voltage_of_the_tmc5130s_board() -> None:
    bench = Bench("tmc5130")
    assert bench.get(9) == 2000
    assert (bench.set(9, 2713), bench.get(9)) == (Status.OK, 2713)
    for wrong in (2714, -1):
        assert (bench.set(9, wrong), bench.get(9)) == (Status.INVALID_VALUE, 2713)


def test_the_global_scaler_is_a_byte() -> None:
    bench = Bench("tmc5160")
    assert (bench.set(35, -1), bench.get(35)) == (Status.OK, 255)
    assert (bench.set(35, 0x180), bench.get(35)) == (Status.OK, 0x80)


def test_more_bits_of_the_boards_with_one_axis() -> None:
    bench = Bench("tmc5130")
    bench.set(34, 1)
    assert bench.read(0) >> 1 & 1 == bench.get(34) == 1
    bench.set(30, 2)
    assert bench.read(RAMPMODE) == bench.get(30) == 2
    bench = Bench("tmc5160")
    for number, value, shift in ((27, 1, 19), (185, 9, 20)):
        bench.set(number, value)
        assert bench.read(CHOPCONF) >> shift & value == bench.get(number) == value
    assert bench.get(34) == 0, "the level at REFR"
    bench.board.patch(BoardPatch.model_validate({"chip": {"axes": [{"axis": 0, "switches": {"right": True}}]}}))
    assert bench.get(34) == 1


@pytest.mark.parametrize(
    ("model", "chopconf", "end", "start"),
    [
        # CHM set: HEND (bits 10..7) and HSTRT (6..4)
        ("tmc5031", 0x4000 | 9 << 7 | 5 << 4, 9, 5),
        ("tmc5062", 0x4000 | 9 << 7 | 5 << 4, 9, 5),
        ("tmc5072", 0x4000 | 9 << 7 | 5 << 4, 9, 5),
        ("tmc5130", 0x4000 | 9 << 7 | 5 << 4, 9, 5),
        ("tmc5160", 0x4000 | 9 << 7 | 5 << 4, 0x4000 >> 7 & 0x780 | 9 & 0x780, (9 << 3 | 5) & 0x70),
        # not set: fast decay (11 and 6..4) and sine offset (10..7)
        ("tmc5031", 1 << 11 | 6 << 7 | 5 << 4, 13, 6),
        ("tmc5062", 1 << 11 | 6 << 7 | 5 << 4, 13, 14),
        ("tmc5072", 1 << 11 | 6 << 7 | 5 << 4, 5, 14),
        ("tmc5130", 6 << 7 | 5 << 4, 8, 8),
        ("tmc5130", 0, 0, 0),
        ("tmc5160", 1 << 11 | 6 << 7 | 5 << 4 | 4, 0x10 & 0x70 | (1 << 7 | 6 << 3 | 5) & 0x70, 8),
        ("tmc5160", 3, 8, 0),
    ],
)
def test_hysteresis_and_fast_decay_read_as_each_board_has_it(
    model: Tmc5xxxModel, chopconf: int, end: int, start: int
) -> None:
    bench = Bench(model)
    bench.ask(BoardOpcode.WRITE_MC, CHOPCONF, 0, chopconf)
    assert (bench.get(165), bench.get(166)) == (end, start)


@pytest.mark.parametrize(
    ("model", "decay"),
    [("tmc5031", 5 << 4), ("tmc5062", 0x800 | 5 << 4), ("tmc5072", 0x800 | 5 << 4), ("tmc5130", 0x800 | 13 << 4),
     ("tmc5160", 5 << 4)],
)  # fmt: skip
def test_hysteresis_and_fast_decay_are_written_as_each_board_does_it(model: Tmc5xxxModel, decay: int) -> None:
    for chm, end, start in ((0x4000, 13 << 7, 6 << 4), (0, decay, 6 << 7)):
        bench = Bench(model)
        bench.ask(BoardOpcode.WRITE_MC, CHOPCONF, 0, chm)
        assert bench.set(165, 13) == Status.OK
        assert bench.read(CHOPCONF) == chm | end
        bench.ask(BoardOpcode.WRITE_MC, CHOPCONF, 0, chm)
        assert bench.set(166, 6) == Status.OK
        assert bench.read(CHOPCONF) == chm | start


@pytest.mark.parametrize("model", DUAL[1:])
def test_who_has_the_pins_of_encoder_and_switches(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    for axis, others, own in ((0, 1 << 3, 1 << 4), (1, 1 << 6, 1 << 5)):
        for value, bits in ((1, own), (0, others)):
            assert bench.set(211, value, axis) == Status.OK
            assert bench.read(0) & (others | own) == bits
            assert bench.get(211, axis) == value


def test_what_the_tmc5031_has_not_is_remembered_or_0() -> None:
    bench = Bench("tmc5031")
    assert (bench.get(210), bench.get(210, 1), bench.get(24), bench.get(209)) == (0x1_0000, 0x1_0000, 0, 0)
    for number, value in ((24, 77), (210, -5), (209, 9)):
        assert bench.set(number, value, 1) == Status.OK
    assert (bench.get(24, 1), bench.get(210, 1), bench.get(209, 1), bench.get(24)) == (77, -5, 0, 0)


@pytest.mark.parametrize("polled_s", [0.004, 0.17])
def test_the_measured_velocity_is_that_of_the_last_milliseconds(bench: Bench, polled_s: float) -> None:
    every_s = 0.025 if bench.chip.model == "tmc5062" else 0.005
    # a microstep, and a tick of 16 us, in the time between two looks
    alike = 1049 / (every_s * 1000) + 200_000 * 16e-6 / every_s + 1
    bench.set(5, 5000)
    assert bench.get(29) == 0
    # the TMC5240's board has another number for it, and reckons with 16 MHz where the chip has 12.5
    number, share = (30, 12.5 / 16) if bench.chip.model == "tmc5240" else (29, 1.0)
    for way, sign in ((Opcode.ROR, 1), (Opcode.ROL, -1)):
        bench.ask(way, 0, 0, 200_000)
        until_s = bench.clock.now() + 0.8 / share
        while bench.clock.now() < until_s:
            bench.clock.set(bench.clock.now() + polled_s)
            actual, measured = bench.get(3) * share, bench.get(number)
            if bench.chip.model == "tmc5031":
                assert measured == 0, "its firmware shows something that never changes"
            else:
                # besides, what the velocity has grown by meanwhile
                slack = alike + 2 * (every_s + polled_s) * 5000 * 122
                assert measured == pytest.approx(actual, abs=slack)
        if bench.chip.model != "tmc5031":
            assert measured == pytest.approx(sign * 200_000 * share, abs=alike)
        assert bench.ask(Opcode.UF4).value == measured
    assert bench.set(number, 0) == Status.WRONG_TYPE
    assert bench.ask(Opcode.UF4, 0, 5).status == Status.WRONG_TYPE


def test_the_tmc5062_goes_on_at_the_speed_from_before_a_rotation() -> None:
    """On its board parameter 4 counts only while it positions; the others take it up with the next move."""
    bench = Bench("tmc5062")
    bench.set(4, 700)
    assert (bench.get(4), bench.get(2)) == (700, 700), "it positions after a reset"
    bench.ask(Opcode.ROR, 0, 0, 5000)
    bench.ask(Opcode.ROR, 0, 0, 6000)
    bench.set(4, 900)
    assert (bench.get(4), bench.get(2)) == (900, 6000)
    bench.chip.heard.clear()
    bench.ask(Opcode.MVP, 0, 0, 10)
    written = [(datagram.address, datagram.data) for datagram in bench.chip.heard if datagram.write]
    assert written == [(VMAX, 700), (XTARGET, 10), (RAMPMODE, 0)]
    bench.set(4, 800)
    bench.chip.heard.clear()
    bench.ask(Opcode.MVP, 0, 0, 20)
    written = [(datagram.address, datagram.data) for datagram in bench.chip.heard if datagram.write]
    assert written == [(XTARGET, 20), (RAMPMODE, 0)]
    assert bench.get(2) == 800


def test_parameters_that_can_only_be_read(bench: Bench) -> None:
    for number in (3, 8, 10, 11, 180, 206):
        assert bench.get(number) is not None
        assert bench.set(number, 1) == Status.WRONG_TYPE
    assert bench.ask(BoardOpcode.USER_FUNCTION_MC, 3).status == Status.WRONG_TYPE


@pytest.mark.parametrize("model", SINGLE)
def test_stealth_chop(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    bench.set(187, 4)
    assert (bench.get(187), bench.read(0) >> 2 & 1) == (4, 1)
    bench.set(187, 0)
    assert bench.read(0) >> 2 & 1 == 0
    assert bench.set(188, 100) == bench.set(191, 3) == bench.set(192, 1) == Status.OK
    assert (bench.get(188), bench.get(191), bench.get(192)) == (100, 3, 1)
    assert bench.set(191, 4) == bench.set(192, 2) == Status.INVALID_VALUE


def test_a_patch_reaches_the_chip_and_what_it_has_not_is_refused(bench: Bench) -> None:
    bench.board.patch(BoardPatch.model_validate({"chip": {"axes": [{"axis": 0, "blocked": True}]}}))
    assert bench.board.state().chip.model == bench.chip.model
    with pytest.raises(UsageError, match="is not for a tmc5"):
        bench.board.patch(BoardPatch.model_validate({"chip": {"blocked": True}}))


def test_reading_what_reading_clears_takes_two_datagrams(bench: Bench) -> None:
    """As with the TMC4361: what comes up between the two is lost."""
    bench.chip.heard.clear()
    bench.read(RAMP_STAT)
    assert [datagram.address for datagram in bench.chip.heard] == [RAMP_STAT] * 2
    table = CATALOG[bench.chip.model].table
    assert table.get("RAMP_STAT", 0).read_clears is (bench.chip.model not in ("tmc5160", "tmc5240"))
