"""The module as a whole: time, faults, heartbeat, silent answers, patches and state."""

from __future__ import annotations

import threading

import pytest
from pydantic import ValidationError

from app.clock import VirtualClock
from app.emulators.build import build_emulator, options_of, warm_up
from app.emulators.tmc428.options import EmulatorOptions
from app.emulators.tmcl.family import FAMILY
from app.emulators.tmcl.module import EmulatedModule
from app.emulators.tmcl.options import TmclOptions, TmclPatch
from app.emulators.tmcl.state import TmclState
from app.errors import BadReply, LinkDown, LinkTimeout, OutOfRange, UnknownThing
from app.links.emulator import EmulatorPort
from app.links.tmcl import Request, check_reply
from app.registers.tmcl.commands import Opcode
from tests.emulators.tmcl.harness import Bench

POSITION = Request(1, Opcode.GAP, 1).encode()


def test_the_factory_knows_models_by_their_options() -> None:
    clock = VirtualClock()
    assert options_of("pd42-1241") is TmclOptions
    assert options_of("tmc428") is EmulatorOptions
    assert isinstance(build_emulator("pd42-1241", clock), EmulatedModule)
    model: str = "pd42-1241"
    assert FAMILY.make(model, clock, TmclOptions(address=7)).state().address == 7
    with pytest.raises(TypeError):
        build_emulator("tmc428", clock, TmclOptions())
    with pytest.raises(TypeError):
        build_emulator(model, clock, EmulatorOptions())
    with pytest.raises(UnknownThing, match="pd42-1241"):
        build_emulator("pd42", clock)
    warm_up()


@pytest.mark.parametrize(
    "options",
    [
        {"address": 0},
        {"address": 256},
        {"baud_code": 12},
        {"time_scale": -1},
        {"supply_v": 61},
        {"colour": "red"},
        {"motor": {"resistance_ohm": 0}},
        {"stage": {"left_at_fullsteps": 5.0, "right_at_fullsteps": 5.0}},
    ],
)
def test_wrong_options_are_refused(options: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        TmclOptions.model_validate(options)


@pytest.mark.parametrize(
    "change",
    [
        {"faults": {"bit_error_rate": 1.1}},
        {"faults": {"late_reply_s": -1}},
        {"faults": {"silence": "perhaps"}},
        {"switches": {"left": "maybe"}},
        {"inputs": {"analog": 4096}},
        {"step_dir": {"pulses": 10, "rate_hz": 0}},
        {"supply_v": float("nan")},
        {"colour": "red"},
    ],
)
def test_wrong_changes_are_refused(change: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        TmclPatch.model_validate(change)


def test_switches_cannot_change_places() -> None:
    bench = Bench()
    before = bench.state.stage
    for change in (
        {"left_at_fullsteps": 4000.0},
        {"right_at_fullsteps": -3750.0},
        {"home_from_fullsteps": 0.0},
        {"left_at_fullsteps": 1.0, "right_at_fullsteps": 1.0},
    ):
        with pytest.raises(OutOfRange):
            bench.patch(stage=change, blocked=True)
    assert bench.state.stage == before
    assert not bench.state.blocked
    assert (
        bench.patch(stage={"left_at_fullsteps": 5000.0, "right_at_fullsteps": 6000.0}).stage.left_at_fullsteps == 5000
    )


# --- time -----------------------------------------------------------------------------------------


def test_it_makes_no_difference_how_often_it_is_asked() -> None:
    def run(pieces: int) -> list[int]:
        bench = Bench()
        bench.do(Opcode.RFS, 0)
        bench.move(50_000)
        for _ in range(pieces):
            bench.run(0.96 / pieces)
            bench.module.exchange(POSITION)
        return [bench.gap(number) for number in (1, 3, 206, 209, 215)]

    assert run(1) == run(96) == run(960)


def test_time_never_goes_back() -> None:
    bench = Bench()
    bench.do(Opcode.ROR, 0, 0, 51_200)
    late = bench.module.exchange(POSITION, 2.0)
    assert bench.module.exchange(POSITION, 1.0) == late
    assert bench.state.chip_time_s == 2.0


def test_time_scale() -> None:
    bench = Bench({"time_scale": 10.0})
    bench.run(1.0)
    assert bench.ggp(132) == 10_000
    bench.patch(time_scale=0.0)
    bench.run(1.0)
    assert bench.ggp(132) == 10_000
    bench.patch(time_scale=1.0)
    bench.run(1.0)
    assert bench.ggp(132) == 11_000


def test_catching_up_in_slices() -> None:
    bench = Bench()
    bench.run(0.5)
    assert not bench.module.caught_up()
    assert not bench.module.catch_up(0.2)
    assert not bench.module.catch_up(0.2)
    assert bench.module.catch_up(0.2)
    assert bench.module.caught_up()


def test_several_threads_may_ask() -> None:
    bench = Bench()
    bench.do(Opcode.ROR, 0, 0, 51_200)
    wrong: list[bytes] = []

    def ask(offset: float) -> None:
        for index in range(200):
            reply = bench.module.exchange(POSITION, offset + index * 0.001)
            if reply[:4] != bytes((2, 1, 100, 6)):
                wrong.append(reply)

    threads = [threading.Thread(target=ask, args=(offset,)) for offset in (0.0, 0.0003, 0.0006)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


# --- what the module says, and does not -----------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "5.1")
def test_suppressed_answers() -> None:
    bench = Bench()
    with pytest.raises(TimeoutError):
        bench.sgp(255, 1)
    for command in ((Opcode.SAP, 4, 0, 1000), (Opcode.GCO, 1), (Opcode.GET_VERSION, 0), (99,), (Opcode.READ_MEMORY,)):
        assert bench.module.receive(Request(1, *command).encode()) is None
    assert bench.module.receive(POSITION[:8] + b"\x00") is None  # not even to a wrong checksum
    assert bench.gap(4) == 1000
    assert bench.ggp(255) == 1
    bench.do(Opcode.GIO, 0, 0)
    assert bench.module.receive(Request(1, Opcode.SGP, 255, 0, 0).encode()) is not None
    with pytest.raises(TimeoutError):
        bench.sgp(255, 1)
    bench.power_cycle()
    assert bench.ggp(255) == 0  # not stored


@pytest.mark.sheet("FM-PD42-1241", "5.1")
def test_the_second_address_is_obeyed_in_silence() -> None:
    bench = Bench()
    bench.sgp(87, 9)
    assert bench.module.receive(Request(9, Opcode.SAP, 4, 0, 777).encode()) is None
    assert bench.gap(4) == 777
    assert bench.module.receive(Request(9, Opcode.GAP, 4).encode()) is None
    bench.sgp(87, 0)
    assert bench.module.receive(Request(0, Opcode.SAP, 4, 0, 888).encode()) is None
    assert bench.gap(4) == 777


@pytest.mark.sheet("FM-PD42-1241", "5.1")
def test_the_telegram_pause_is_for_the_line_to_make() -> None:
    bench = Bench()
    assert bench.module.reply_pause_s == 0
    bench.sgp(75, 25)
    assert bench.module.reply_pause_s == 0.025


@pytest.mark.sheet("FM-PD42-1241", "5.1")
def test_without_heartbeat_the_motor_stops() -> None:
    bench = Bench()
    bench.sgp(68, 500)
    bench.do(Opcode.ROR, 0, 0, 51_200)
    for _ in range(10):  # any command is one
        bench.run(0.4)
        assert bench.gap(2) == 51_200
    heard_s = bench.clock.now()
    bench.run(0.499)
    assert bench.state.truth.speed_rad_s > 1  # looking is no command
    bench.run(2.0)
    assert (bench.gap(2), bench.gap(3)) == (0, 0)
    bench.do(Opcode.ROR, 0, 0, 51_200)
    bench.run(0.1)
    assert bench.gap(3) > 0
    assert bench.clock.now() > heard_s


@pytest.mark.sheet("FM-PD42-1241", "5.1")
def test_what_does_and_does_not_count_as_heartbeat() -> None:
    bench = Bench()
    bench.sgp(68, 100)
    bench.do(Opcode.RFS, 0)
    bench.module.receive(Request(2, Opcode.GAP, 1).encode(), 0.05)  # another master's
    bench.module.receive(POSITION[:8] + b"\x00", 0.06)  # broken
    bench.run(0.11)
    assert bench.do(Opcode.RFS, 2) == 0
    bench.sgp(68, 0)
    bench.do(Opcode.ROR, 0, 0, 1000)
    bench.run(5.0)
    assert bench.gap(2) == 1000


# --- faults ---------------------------------------------------------------------------------------


def test_silence_answers_nothing_but_the_module_has_heard() -> None:
    bench = Bench()
    bench.patch(faults={"silence": True})
    with pytest.raises(TimeoutError):
        bench.sap(4, 77)
    assert bench.module.receive(POSITION) is not None  # a line keeps the answer, not the module
    bench.patch(faults={"silence": False})
    assert bench.gap(4) == 77


def test_a_late_answer_is_none_where_there_is_no_line() -> None:
    bench = Bench()
    bench.patch(faults={"late_reply_s": 0.3})
    with pytest.raises(TimeoutError):
        bench.sap(4, 77)
    assert bench.module.faults.late_reply_s == 0.3
    bench.patch(faults={"late_reply_s": 0.0})
    assert bench.gap(4) == 77


def test_unplugged_hears_nothing() -> None:
    bench = Bench()
    bench.patch(faults={"unplugged": True})
    with pytest.raises(ConnectionError):
        bench.sap(4, 77)
    bench.patch(faults={"unplugged": False})
    assert bench.gap(4) == 51_200


def test_bit_errors_come_at_their_rate_and_by_seed() -> None:
    right = Bench().module.exchange(POSITION)

    def errors(seed: int) -> list[int]:
        bench = Bench({"seed": seed})
        bench.patch(faults={"bit_error_rate": 0.01})
        replies = [bench.module.exchange(POSITION) for _ in range(1000)]
        return [(int.from_bytes(reply, "big") ^ int.from_bytes(right, "big")).bit_count() for reply in replies]

    first = errors(1)
    assert sum(first) == pytest.approx(1000 * 72 * 0.01, rel=0.2)
    assert first == errors(1) != errors(2)


def test_half_frames_come_at_their_rate() -> None:
    bench = Bench()
    bench.patch(faults={"half_frame_rate": 0.5})
    lengths = [len(bench.module.exchange(POSITION)) for _ in range(400)]
    assert sum(length < 9 for length in lengths) == pytest.approx(200, rel=0.2)
    assert min(lengths) == 1
    assert bench.state.faults.half_frame_rate == 0.5


async def test_a_port_tells_every_fault_as_what_it_is() -> None:
    bench = Bench()
    port = EmulatorPort(bench.module)
    assert check_reply(port.name, POSITION, await port.exchange(POSITION)).value == 0
    bench.patch(faults={"unplugged": True})
    with pytest.raises(LinkDown):
        await port.exchange(POSITION)
    bench.patch(faults={"unplugged": False, "silence": True})
    with pytest.raises(LinkTimeout):
        await port.exchange(POSITION)
    bench.patch(faults={"silence": False, "bit_error_rate": 1.0})
    with pytest.raises(BadReply):
        check_reply(port.name, POSITION, await port.exchange(POSITION))
    bench.patch(faults={"bit_error_rate": 0.0, "half_frame_rate": 1.0})
    with pytest.raises(BadReply):
        check_reply(port.name, POSITION, await port.exchange(POSITION))


async def test_it_is_sampled_in_process_at_1_khz() -> None:
    bench = Bench()
    port = EmulatorPort(bench.module)
    bench.do(Opcode.ROR, 0, 0, 51_200)
    samples: list[float] = []
    end = port.start_sampling([POSITION, Request(1, Opcode.GAP, 209).encode()], 0.001, lambda at, _: samples.append(at))
    bench.run(1.0)
    port.run_due_samples()
    end()
    assert len(samples) == 1001
    assert samples[500] == pytest.approx(0.5)


# --- state ----------------------------------------------------------------------------------------


def test_every_field_of_the_state_is_there_as_json() -> None:
    bench = Bench()
    bench.move(10_000)
    bench.run(0.4)
    state = bench.state
    assert TmclState.model_validate_json(state.model_dump_json()) == state
    assert state.model == "pd42-1241"
    assert state.motor.fullsteps_per_turn == 200
    assert state.truth.rotor_fullsteps == state.stage.position_fullsteps
    assert abs(state.truth.load_angle_deg) < 90
    assert state.eeprom_path is None


def test_a_patch_changes_what_it_names_and_nothing_else() -> None:
    bench = Bench()
    before = bench.state
    changed = bench.patch(load_torque_nm=0.1, friction=0.02, blocked=True, supply_v=30.0)
    assert (changed.load_torque_nm, changed.friction, changed.blocked, changed.supply_v) == (0.1, 0.02, True, 30.0)
    assert changed.switches == before.switches
    assert changed.faults == before.faults
    assert bench.patch().model_dump(exclude={"chip_time_s"}) == changed.model_dump(exclude={"chip_time_s"})


def test_friction_and_load_are_felt() -> None:
    def load_angle(**change: object) -> float:
        bench = Bench()
        bench.sap(7, 128)
        bench.patch(**change)
        bench.run(1.0)
        return abs(bench.state.truth.load_angle_deg)

    assert load_angle(load_torque_nm=0.15) > load_angle() + 10
