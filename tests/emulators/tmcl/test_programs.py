"""The interpreter of the module: every command of programs, what each waits for, and how programs end."""

from __future__ import annotations

import pytest

from app.registers.tmcl.commands import PROGRAM_COMMANDS, Opcode, Status
from tests.calc.tmcl_programs import (
    FIRST,
    MAIN_LOOP,
    POTENTIOMETER,
    PY_TEST,
    ROUTINES,
    STEP_DIRECTION,
    SUBROUTINE,
    SYMBOLS,
)
from tests.emulators.tmcl.harness import FULLSTEP, Bench
from tests.emulators.tmcl.programs import COMMAND_S, accumulator, commands_of, download, ended, started

SWITCHES: dict[str, object] = {
    "stage": {
        "left_at_fullsteps": -40.0,
        "right_at_fullsteps": 40.0,
        "home_from_fullsteps": 8.0,
        "home_to_fullsteps": 12.0,
    }
}
QUICK = "SAP 4, 0, 51200\nSAP 5, 0, 512000\nSAP 17, 0, 512000\n"


# --- the manual's examples ------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "2.4")
@pytest.mark.sheet("FM-PD42-1241", "3.3")
def test_the_first_program() -> None:
    bench = started(FIRST)
    bench.run(4.0)
    assert bench.gap(3) == -51_200
    bench.run(6.0)
    assert bench.gap(3) == 51_200
    bench.run(5.0)
    seen = set()
    for _ in range(120):
        bench.run(0.5)
        if bench.gap(8):
            seen.add(bench.gap(1))
    assert seen <= {512_000, -512_000}
    bench.until(lambda: bench.gap(0) == -512_000)
    bench.until(lambda: bench.gap(0) == 512_000)


@pytest.mark.sheet("FM-PD42-1241", "8")
@pytest.mark.sheet("FM-PD42-1241", "8.1")
@pytest.mark.sheet("FM-PD42-1241", "8.2")
@pytest.mark.parametrize(("text", "there"), [(MAIN_LOOP, 5000), (SYMBOLS, 500_000)])
def test_a_main_loop_goes_between_two_positions(text: str, there: int) -> None:
    bench = started(text)
    for target in (there, 0, there, 0):
        bench.until(lambda target=target: bench.gap(0) == target, step_s=0.05)  # type: ignore[misc]
        bench.until(lambda target=target: bench.gap(1) == target, step_s=0.0005)  # type: ignore[misc]
    assert (bench.gap(4), bench.gap(5)) == (50_000, 10_000)
    assert bench.ggp(128) == 1


@pytest.mark.sheet("FM-PD42-1241", "3.6.18")
@pytest.mark.sheet("FM-PD42-1241", "3.6.19")
@pytest.mark.sheet("FM-PD42-1241", "8.5")
def test_the_subroutine_example() -> None:
    bench = started(f"{QUICK}{SUBROUTINE}")
    bench.until(lambda: bench.state.application.stack != [])
    assert bench.state.application.stack == [5]
    bench.until(lambda: bench.gap(1) == 10_000, step_s=0.001)
    took = bench.until(lambda: bench.gap(0) == 0, step_s=0.001)
    assert took == pytest.approx(0.5, abs=0.02)  # WAIT TICKS, 0, 50 after the position
    bench.until(lambda: bench.state.application.stack == [7])


@pytest.mark.sheet("FM-PD42-1241", "8.6")
@pytest.mark.sheet("FM-PD42-1241", "3.6.36")
def test_routines_that_a_host_calls() -> None:
    bench = Bench()
    bench.sap(4, 51_200)
    bench.sap(5, 51_200)
    download(bench, commands_of(ROUTINES))
    bench.do(Opcode.RUN_APPLICATION, 1, 0, 0)
    bench.until(lambda: bench.gap(1) == 1000, step_s=0.001)
    bench.until(lambda: bench.ggp(128) == 0)
    assert bench.gap(1) == 0
    assert bench.ggp(130) == 7
    for routine, speed, seconds in ((1, -500, 1.0), (2, 1000, 7.0)):
        bench.do(Opcode.RUN_APPLICATION, 1, 0, routine)
        bench.run(seconds - 0.05)
        assert (bench.gap(3), bench.ggp(128)) == (speed, 1)
        bench.run(0.1)
        assert (bench.gap(2), bench.ggp(128)) == (0, 0)


@pytest.mark.sheet("FM-PD42-1241", "3.6.27")
def test_the_potentiometer_example() -> None:
    bench = started(POTENTIOMETER)
    bench.patch(inputs={"analog": 700})
    bench.until(lambda: bench.gap(1) == 2800)
    bench.patch(inputs={"analog": 4095})
    bench.until(lambda: bench.gap(1) == 16_380)


@pytest.mark.sheet("FM-PD42-1241", "6.4")
def test_the_step_direction_example_starts_by_itself() -> None:
    bench = Bench()
    download(bench, commands_of(STEP_DIRECTION))
    bench.sgp(77, 1)
    bench.power_cycle()
    bench.run(0.01)
    assert (bench.gap(6), bench.gap(7), bench.gap(254), bench.ggp(128)) == (200, 8, 1, 0)


def test_a_program_that_others_published() -> None:
    bench = Bench()
    bench.sap(4, 51_200)
    bench.sap(5, 512_000)
    download(bench, commands_of(PY_TEST))
    bench.do(Opcode.RUN_APPLICATION, 1, 0, 0)
    for target in (51_200, 0, 51_200):  # each arrival is an interrupt that goes the other way
        bench.until(lambda target=target: bench.gap(0) == target, step_s=0.02)  # type: ignore[misc]


# --- calculating, comparing, jumping --------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "8.4")
@pytest.mark.sheet("FM-PD42-1241", "3.5.5")
def test_reads_feed_the_accumulator() -> None:
    bench = Bench(SWITCHES)
    bench.patch(inputs={"analog": 1234})
    text = """GAP 4, 0\nAGP 0, 2\nGGP 66, 0\nAGP 1, 2\nGIO 0, 1\nAGP 2, 2\nSCO 3, 0, -77\nGCO 3, 0\nAGP 3, 2
              CALC LOAD, 5\nRFS STATUS, 0\nAGP 4, 2\nCALC LOAD, 9\nCCO 1, 0\nRFS STOP, 0\nAGP 5, 2\nSTOP"""
    speed = bench.gap(4)
    ended(text, bench=bench)
    assert [bench.ggp(number, 2) for number in range(6)] == [speed, 1, 1234, -77, 0, 9]


@pytest.mark.sheet("FM-PD42-1241", "3.6.15")
@pytest.mark.sheet("FM-PD42-1241", "3.6.16")
@pytest.mark.sheet("FM-PD42-1241", "3.5.3")
@pytest.mark.parametrize(
    ("left", "true"),
    [
        (-5, {"NZ", "NE", "LT", "LE"}),
        (0, {"ZE", "NE", "LT", "LE"}),
        (7, {"NZ", "EQ", "GE", "LE"}),
        (8, {"NZ", "NE", "GT", "GE"}),
    ],
)
def test_every_condition_after_a_comparison(left: int, true: set[str]) -> None:
    conditions = ["ZE", "NZ", "EQ", "NE", "GT", "GE", "LT", "LE", "ETO", "EAL", "EDV", "EPO"]
    tests = "".join(
        f"JC {condition}, Yes{at}\nJA No{at}\nYes{at}: SGP {at}, 2, 1\nNo{at}:\n"
        for at, condition in enumerate(conditions)
    )
    bench = ended(f"CALC LOAD, {left}\nCOMP 7\n{tests}STOP")
    assert {condition for at, condition in enumerate(conditions) if bench.ggp(at, 2)} == true


@pytest.mark.sheet("FM-PD42-1241", "3.6.17")
def test_jumping_takes_one_command() -> None:
    bench = started("GGP 0, 2\nLoop: CALC ADD, 1\nAGP 0, 2\nJA Loop")
    bench.run(0.3)
    assert bench.ggp(0, 2) == pytest.approx(0.3 / COMMAND_S / 3, abs=1)


@pytest.mark.sheet("FM-PD42-1241", "3.6.18")
@pytest.mark.sheet("FM-PD42-1241", "3.6.19")
def test_a_ninth_call_and_a_return_from_nowhere_are_ignored() -> None:
    bench = ended(
        "RSUB\nDeeper: GGP 0, 2\nCALC ADD, 1\nAGP 0, 2\nCSUB Deeper\n"
        "GGP 1, 2\nCALC ADD, 1\nAGP 1, 2\nCOMP 9\nJC EQ, End\nRSUB\nEnd: STOP"
    )
    assert (bench.ggp(0, 2), bench.ggp(1, 2)) == (9, 9)
    assert bench.state.application.stack == []


# --- waiting --------------------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "3.6.20")
@pytest.mark.parametrize(
    ("text", "seconds"),
    [("WAIT TICKS, 0, 50", 0.5), ("CALC LOAD, 7\nWAIT TICKS, 0, -1", 0.07), ("WAIT TICKS, 0, 0", 0.0),
     ("CALC LOAD, -3\nWAIT TICKS, 0, -1", 0.0), ("WAIT POS, 0, 0", 0.0), ("WAIT RFS, 0, 0", 0.0)],
)  # fmt: skip
def test_waiting_for_time(text: str, seconds: float) -> None:
    bench = started(f"{text}\nSTOP")
    took = bench.until(lambda: bench.ggp(128) == 0, step_s=COMMAND_S)
    assert took == pytest.approx(seconds + COMMAND_S * (text.count("\n") + 2), abs=2.5 * COMMAND_S)


@pytest.mark.sheet("FM-PD42-1241", "3.6.20")
@pytest.mark.sheet("FM-PD42-1241", "3.6.29")
@pytest.mark.parametrize("condition", ["POS", "REFSW", "LIMSW", "RFS"])
def test_waiting_for_an_event_and_its_time_limit(condition: str) -> None:
    start = {"POS": "MVP ABS, 0, 5120", "RFS": "SAP 193, 0, 1\nSAP 194, 0, 5120\nRFS START, 0"}.get(
        condition, "ROR 0, 5120"
    )
    text = (
        f"{QUICK}{start}\nWAIT {condition}, 0, LIMIT\nJC ETO, Late\nSGP 0, 2, 1\nSTOP\nLate: CLE ETO\nSGP 0, 2, 2\nSTOP"
    )
    bench = ended(text.replace("LIMIT", "0"), bench=Bench(SWITCHES))
    assert bench.ggp(0, 2) == 1
    if condition == "POS":
        assert bench.gap(1) == 5120
    elif condition == "RFS":
        assert (bench.gap(10), bench.state.search.phase) == (0, "")
    else:
        bench.gap(9)
        assert bench.state.switches.home.active == (condition == "REFSW")
        assert bench.gap(1) == pytest.approx((8 if condition == "REFSW" else 40) * FULLSTEP, abs=40)
    slow = ended(text.replace("LIMIT", "10"), bench=Bench(SWITCHES))
    assert slow.ggp(0, 2) == 2
    assert "ETO" not in slow.state.application.flags


def test_a_wait_shows_and_a_stop_ends_it() -> None:
    bench = started("WAIT POS, 0, 0\nSAP 5, 0, 1000\nMVP ABS, 0, 512000\nWAIT POS, 0, 0\nSTOP")
    bench.run(0.1)
    assert bench.do(Opcode.GET_STATUS, 1) == 1 << 24 | 1 << 16 | 3
    assert bench.state.application.waits
    bench.do(Opcode.STOP_APPLICATION)
    assert (bench.ggp(128), bench.ggp(130)) == (0, 3)
    assert bench.gap(2) == 0  # MVP goes on: stopping the program is not stopping the motor
    assert bench.gap(3) > 0
    bench.do(Opcode.MST)
    bench.stand()
    bench.sap(0, bench.gap(1))
    bench.do(Opcode.RUN_APPLICATION)
    bench.run(0.1)
    assert (bench.ggp(128), bench.ggp(130)) == (0, 4)


# --- coordinates, ports, errors -------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "3.6.25")
def test_coordinates_and_ports_in_programs() -> None:
    bench = ended(f"{QUICK}CALC LOAD, 2560\nACO 2, 0\nMVP COORD, 0, 2\nWAIT POS, 0, 0\nCCO 4, 0\nSIO 0, 2, 1\nSTOP")
    assert (bench.gap(1), bench.do(Opcode.GCO, 4), bench.do(Opcode.GIO, 0, 2)) == (2560, 2560, 1)


@pytest.mark.parametrize(
    ("line", "status"),
    [("SAP 4, 0, -1", Status.INVALID_VALUE), ("SAP 1, 1, 0", Status.INVALID_VALUE), ("GAP 250, 0", Status.WRONG_TYPE),
     ("CALC DIV, 0", Status.INVALID_VALUE), ("CALC SWAP_, 0", Status.WRONG_TYPE), ("WAIT 5, 0, 0", Status.WRONG_TYPE),
     ("WAIT POS, 1, 0", Status.INVALID_VALUE), ("JC 12, 0", Status.WRONG_TYPE), ("EI 9", Status.WRONG_TYPE),
     ("VECT 255, 0", Status.WRONG_TYPE), ("CLE 5", Status.WRONG_TYPE),
     (".command 22, 0, 0, 5000", Status.INVALID_VALUE)],
)  # fmt: skip
def test_a_refused_command_is_passed_over_and_its_status_kept(line: str, status: Status) -> None:
    # Open in all sources; decided in `interpreter`.
    bench = ended(f"CALC LOAD, 3\n{line.replace('SWAP_', '10')}\nAGP 0, 2\nSTOP")
    assert (bench.ggp(0, 2), bench.ggp(131)) == (3, status)


@pytest.mark.parametrize("opcode", [0, 7, 29, 64, 99, 127])
def test_an_unknown_command_stops_the_program(opcode: int) -> None:
    bench = ended(f"SGP 0, 2, 5\n.command {opcode}, 0, 0, 1234\nSGP 0, 2, 6\nSTOP")
    assert (bench.ggp(0, 2), bench.ggp(130), bench.ggp(131)) == (5, 1, Status.INVALID_COMMAND)


@pytest.mark.sheet("FM-PD42-1241", "3.6.21")
def test_programs_end_at_stop_and_at_the_end_of_memory() -> None:
    bench = ended("STOP\nSGP 0, 2, 5\nSTOP")
    assert (bench.ggp(0, 2), bench.ggp(130), bench.ggp(131)) == (0, 0, 0)
    bench = Bench()
    download(bench, commands_of("SGP 0, 2, 5"), PROGRAM_COMMANDS - 1)
    bench.do(Opcode.RUN_APPLICATION, 1, 0, PROGRAM_COMMANDS - 1)
    bench.run(0.01)
    assert (bench.ggp(0, 2), bench.ggp(128), bench.ggp(131)) == (5, 0, Status.INVALID_COMMAND)


def test_writing_the_eeprom_takes_its_time() -> None:
    bench = started("Loop: GGP 0, 2\nCALC ADD, 1\nAGP 0, 2\nSTGP 0, 2\nJA Loop")
    bench.run(1.0)
    assert bench.ggp(0, 2) == pytest.approx(1 / (0.005 + 5 * COMMAND_S), abs=2)


# --- control ----------------------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "3.6.36")
def test_stepping() -> None:
    bench = Bench()
    download(bench, commands_of("CALC LOAD, 7\nCSUB Sub\nWAIT TICKS, 0, 10\nSTOP\nSub: CALC ADD, 1\nRSUB"))
    seen = []
    for _ in range(4):
        bench.do(Opcode.STEP_APPLICATION)
        seen.append((bench.ggp(130), accumulator(bench)))
        bench.run(0.01)
    assert seen == [(1, 7), (4, 7), (5, 8), (2, 8)]
    assert bench.ggp(128) == 2
    bench.do(Opcode.STEP_APPLICATION)  # a WAIT is one command however long it takes
    bench.run(0.05)
    assert (bench.ggp(130), bench.state.application.waits) == (2, True)
    bench.run(0.06)
    assert (bench.ggp(130), bench.state.application.waits, bench.ggp(128)) == (3, False, 2)
    bench.run(1.0)
    assert bench.ggp(130) == 3
    bench.do(Opcode.STEP_APPLICATION)
    assert (bench.ggp(130), bench.ggp(128)) == (3, 0)


def test_a_program_stops_for_a_download_and_none_is_run_in_it() -> None:
    bench = started("Loop: JA Loop")
    bench.run(0.1)
    bench.do(Opcode.ENTER_DOWNLOAD)
    assert bench.state.application.status == "stopped"
    for opcode in (Opcode.RUN_APPLICATION, Opcode.STEP_APPLICATION):
        assert bench.ask(opcode).status == Status.NOT_AVAILABLE
    bench.do(Opcode.EXIT_DOWNLOAD)
    bench.do(Opcode.RUN_APPLICATION)
    assert bench.ggp(128) == 1


@pytest.mark.sheet("FM-PD42-1241", "8.6")
def test_direct_mode_beside_a_program() -> None:
    bench = started("Loop: GGP 0, 2\nCOMP 5\nJC NE, Loop\nSGP 1, 2, 77\nEnd: GGP 1, 2\nJA End")
    bench.run(0.1)
    assert bench.ggp(1, 2) == 0
    bench.sgp(0, 5, bank=2)
    bench.run(0.01)
    assert bench.ggp(1, 2) == 77
    bench.gap(4)
    bench.ggp(66)
    bench.run(0.01)
    assert accumulator(bench) == 77


@pytest.mark.sheet("FM-PD42-1241", "8.7")
def test_automatic_start_at_power_on() -> None:
    bench = started("SGP 77, 0, 1\nGGP 0, 2\nCALC ADD, 1\nAGP 0, 2\nSTGP 0, 2\nSTOP")
    for count in (1, 2, 3):
        bench.run(0.1)
        assert (bench.ggp(0, 2), bench.ggp(128)) == (count, 0)
        bench.power_cycle()


def test_a_protected_program_runs_and_losing_the_protection_ends_it() -> None:
    bench = started("SGP 81, 0, 3\nLoop: GGP 0, 2\nCALC ADD, 1\nAGP 0, 2\nJA Loop")
    bench.run(0.1)
    assert bench.ggp(0, 2) > 100
    assert bench.ask(Opcode.READ_MEMORY).status == Status.EEPROM_LOCKED
    bench.sgp(81, 0)
    bench.run(0.1)
    assert (bench.ggp(128), bench.ggp(131)) == (0, Status.INVALID_COMMAND)


# --- interrupts -----------------------------------------------------------------------------------

COUNTING = "VECT {number}, Irq\nEI {number}\nEI 255\n{main}Loop: JA Loop\nIrq: GGP 0, 2\nCALC ADD, 1\nAGP 0, 2\nRETI"


@pytest.mark.sheet("FM-PD42-1241", "3.5.6")
@pytest.mark.sheet("FM-PD42-1241", "3.5.6.3")
@pytest.mark.sheet("FM-PD42-1241", "3.5.6.4")
@pytest.mark.sheet("FM-PD42-1241", "3.6.30")
@pytest.mark.sheet("FM-PD42-1241", "3.6.32")
@pytest.mark.sheet("FM-PD42-1241", "3.6.33")
@pytest.mark.parametrize("timer", [0, 1, 2])
def test_timers(timer: int) -> None:
    bench = started(COUNTING.format(number=timer, main=f"SGP {timer}, 3, 20\n"))
    bench.run(1.01)
    assert bench.ggp(0, 2) == 50


@pytest.mark.sheet("FM-PD42-1241", "3.5.6.4")
def test_the_timer_example() -> None:
    # its output 3 is not there on this module: those commands are refused and passed over
    text = """VECT 0, Timer0Irq\nSGP 0, 3, 1000\nEI 0\nEI 255\nLoop: SIO 3, 2, 1\nWAIT TICKS, 0, 50\nSIO 3, 2, 0
              WAIT TICKS, 0, 50\nJA Loop\nTimer0Irq: GIO 0, 2\nJC NZ, Out0Off\nSIO 0, 2, 1\nRETI
              Out0Off: SIO 0, 2, 0\nRETI"""
    bench = started(text)
    levels = []
    for _ in range(4):
        bench.run(1.0)
        levels.append(bench.do(Opcode.GIO, 0, 2))
    assert levels == [0, 1, 0, 1] or levels == [1, 0, 1, 0]


@pytest.mark.sheet("FM-PD42-1241", "3.5.6.2")
def test_the_context_is_saved_and_nothing_nests() -> None:
    text = """VECT 0, Irq\nVECT 1, Other\nSGP 0, 3, 70\nSGP 1, 3, 75\nEI 0\nEI 1\nEI 255\nCALC LOAD, -3\nCALCX LOAD
              CALC LOAD, 11\nCOMP 20\nLoop: JC LT, Right\nSTOP\nRight: JC NZ, Loop\nSTOP
              Irq: CALC LOAD, 0\nCALCX LOAD\nCOMP -1\nWAIT TICKS, 0, 5\nGGP 0, 2\nCALC ADD, 1\nAGP 0, 2\nGGP 1, 2
              COMP 0\nJC EQ, Fine\nSGP 2, 2, 1\nFine: RETI
              Other: SGP 1, 2, 1\nGGP 3, 2\nCALC ADD, 1\nAGP 3, 2\nSGP 1, 2, 0\nRETI"""
    bench = started(text)
    bench.run(1.5)
    assert bench.ggp(128) == 1
    assert bench.ggp(0, 2) > 5
    assert bench.ggp(3, 2) > 5
    assert bench.ggp(2, 2) == 0  # never within the other
    bench.until(lambda: not bench.state.application.interrupted, step_s=COMMAND_S)
    assert (accumulator(bench), bench.do(Opcode.GET_STATUS, 3)) == (11, -3)


@pytest.mark.sheet("FM-PD42-1241", "5.4")
def test_the_lower_number_has_priority_and_each_is_kept_once() -> None:
    text = """VECT 0, A\nVECT 1, B\nSGP 0, 3, 3\nSGP 1, 3, 3\nEI 1\nEI 0
              WAIT TICKS, 0, 2\nSGP 1, 3, 0\nSGP 0, 3, 0\nEI 255
              STOP\nA: GGP 0, 2\nCALC MUL, 10\nCALC ADD, 1\nAGP 0, 2\nRETI
              B: GGP 0, 2\nCALC MUL, 10\nCALC ADD, 2\nAGP 0, 2\nRETI"""
    assert ended(text).ggp(0, 2) == 12


@pytest.mark.sheet("FM-PD42-1241", "3.6.31")
def test_disabled_interrupts_do_not_come() -> None:
    bench = started(COUNTING.format(number=0, main="SGP 0, 3, 5\nWAIT TICKS, 0, 10\nDI 0\nWAIT TICKS, 0, 10\nEI 0\n"))
    bench.run(0.05)
    assert bench.ggp(0, 2) > 5
    bench.run(0.06)
    before = bench.ggp(0, 2)
    bench.run(0.08)
    assert bench.ggp(0, 2) == before
    bench.run(0.1)
    assert bench.ggp(0, 2) > before
    bench.do(Opcode.DI, 255)
    before = bench.ggp(0, 2)
    bench.run(0.1)
    assert bench.ggp(0, 2) == before


@pytest.mark.sheet("FM-PD42-1241", "3.5.6.1")
@pytest.mark.sheet("FM-PD42-1241", "5.4")
@pytest.mark.parametrize(
    ("number", "on", "off"),
    [
        (27, {"switches": {"left": True}}, {"switches": {"left": False}}),
        (28, {"switches": {"right": True}}, {"switches": {"right": False}}),
        (39, {"switches": {"home": True}}, {"switches": {"home": False}}),
        (40, {"inputs": {"in1": True}}, {"inputs": {"in1": False}}),
        (41, {"inputs": {"in2": True}}, {"inputs": {"in2": False}}),
        (42, {"inputs": {"analog": 4000}}, {"inputs": {"analog": 0}}),
    ],
)
def test_edges_of_inputs(number: int, on: dict[str, object], off: dict[str, object]) -> None:
    for edges, counted in ((0, 0), (1, 2), (2, 2), (3, 4)):
        bench = Bench()
        bench.patch(**off)
        started(COUNTING.format(number=number, main=f"SGP {number}, 3, {edges}\n"), bench)
        for change in (on, off, on, off):
            bench.run(0.01)
            bench.patch(**change)
        bench.run(0.01)
        assert bench.ggp(0, 2) == counted, edges


@pytest.mark.sheet("FM-PD42-1241", "3.5.6.1")
def test_a_switch_on_the_way_interrupts_when_it_is_reached() -> None:
    text = f"{QUICK}VECT 39, Irq\nSGP 39, 3, 1\nEI 39\nEI 255\nROR 0, 5120\nLoop: JA Loop\n"
    text += "Irq: GAP 1, 0\nAGP 0, 2\nMST 0\nRETI"
    bench = started(text, Bench(SWITCHES))
    bench.run(2.0)
    assert bench.ggp(0, 2) == pytest.approx(8 * FULLSTEP, abs=4)


@pytest.mark.sheet("FM-PD42-1241", "3.5.6.1")
def test_stall_and_deviation_interrupt() -> None:
    bench = Bench()
    bench.sap(5, 200_000)
    bench.sap(181, 1000)
    bench.sap(174, 0)
    started(COUNTING.format(number=15, main="ROR 0, 51200\n"), bench)
    bench.run(1.5)
    assert bench.ggp(0, 2) == 0
    bench.patch(blocked=True)
    bench.run(1.0)
    assert bench.ggp(0, 2) == 1
    bench = Bench()
    bench.sap(5, 200_000)
    bench.sap(212, 2000)
    started(COUNTING.format(number=21, main="ROR 0, 51200\n"), bench)
    bench.run(1.0)
    assert (bench.ggp(0, 2), "EDV" in bench.state.application.flags) == (0, False)
    bench.patch(blocked=True)
    bench.run(1.0)
    assert (bench.ggp(0, 2), "EDV" in bench.state.application.flags) == (1, True)


# --- commands of later firmware (TMCM-1290) ---------------------------------------------------------

LATER: dict[str, object] = {"later_commands": True}


@pytest.mark.parametrize(
    ("text", "variables"),
    [
        ("CALCV LOAD, 0, 12\nCALCV MUL, 0, 3\nCALCVV LOAD, 1, 0\nCALCVV SUB, 1, 0", [36, 0]),
        ("CALCV LOAD, 0, 5\nCALC LOAD, 7\nCALCVA ADD, 0\nCALCAV MUL, 0\nAGP 1, 2", [12, 84]),
        ("CALCV LOAD, 0, 9\nCALC LOAD, 4\nCALCX LOAD\nCALCXV ADD, 0\nCALCVX LOAD, 1", [9, 13]),
        ("CALCV LOAD, 0, 1\nCALCV LOAD, 1, 2\nCALCVV SWAP, 0, 1", [2, 1]),
        ("CALCV LOAD, 0, 3\nAgain: CALCV ADD, 1, 10\nDJNZ 0, Again", [0, 30]),
        ("CALCV COMP, 0, 0\nCALL EQ, Sub\nSTOP\nSub: CALCV LOAD, 1, 5\nRSUB", [0, 5]),
        ("CALC LOAD, 1\nCALCX LOAD\nSIV 77\nGIV\nCALC ADD, 1\nAIV", [0, 78]),
    ],
)
def test_later_commands_by_example(text: str, variables: list[int]) -> None:
    bench = ended(f"{text}\nSTOP", bench=Bench(LATER))
    assert [bench.ggp(number, 2) for number in range(2)] == variables


def test_later_moves_by_the_accumulator() -> None:
    bench = ended(f"{QUICK}CALC LOAD, 2560\nMVPA ABS, 0\nWAIT POS, 0, 0\nSTOP", bench=Bench(LATER))
    assert bench.gap(1) == 2560
    ended("CALC LOAD, 500\nRORA 0\nSTOP", bench=bench)
    assert bench.gap(2) == 500
    ended("CALC LOAD, 500\nROLA 0\nSTOP", bench=bench)
    assert bench.gap(2) == -500


def test_a_restart_forgets_the_registers() -> None:
    bench = started("CALC LOAD, 5\nCALCX LOAD\nCSUB Sub\nSub: RST 5\nSTOP\nEnd: JA End", Bench(LATER))
    bench.run(0.01)
    state = bench.state.application
    assert (state.accumulator, state.x, state.stack, state.counter, state.flags) == (0, 0, [], 5, ["ZERO"])


def test_direct_mode_knows_them_where_the_firmware_does() -> None:
    bench = Bench(LATER)
    bench.do(Opcode.CALCV, 9, 3, 42)
    bench.do(Opcode.CALCAV, 9, 3)
    assert (bench.ggp(3, 2), accumulator(bench)) == (42, 42)
    assert bench.ask(Opcode.CALCV, 12, 3).status == Status.WRONG_TYPE
    assert bench.ask(Opcode.CALCVV, 0, 3, 256).status == Status.INVALID_VALUE
    assert bench.ask(Opcode.DJNZ).status == Status.NOT_AVAILABLE
    assert Bench().ask(Opcode.CALCV, 9, 3, 42).status == Status.INVALID_COMMAND
