"""TMCL programs on the emulated module: how fast, and whether ten thousand random ones do what they should.

Speeds are those of one module that nobody else asks, by processor time. A loop that polls the position runs beside a
rigid motor, whose constant velocities cost nothing, and beside the motor with its physics, where it may cost a quarter
of what the motor costs alone.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from app.calc.tmcl.assembler import assemble
from app.links.tmcl_language import INSTRUCTIONS
from tests.bench.table import Row
from tests.emulators.tmcl.harness import Bench
from tests.emulators.tmcl.programs import started
from tests.emulators.tmcl.random_programs import LATER, agree, any_bytes

COMMANDS_PER_S = 1e6
LOOPS_X = 1000.0
MOVING_X = 100.0
POLLING_COST = 1.25
PROGRAMS = 10_000
ASSEMBLY_S = 0.05
COUNTING = "Loop: CALC ADD, 1\nAGP 0, 2\nGGP 0, 2\nCOMP 0\nJC EQ, Loop\nJA Loop"
THERE_AND_BACK = """\
Loop: MVP ABS, 0, 51200000
There: GAP 1, 0
COMP 51200000
JC LT, There
MVP ABS, 0, 0
Back: GAP 1, 0
COMP 0
JC GT, Back
JA Loop
"""
WAITING = "Loop: MVP ABS, 0, 51200000\nWAIT POS, 0, 0\nMVP ABS, 0, 0\nWAIT POS, 0, 0\nJA Loop"
AT_REST = "Loop: GAP 1, 0\nCOMP 10\nJC LT, Loop\nSTOP"
TURNING = "ROR 0, 51200\nSTOP"
RIGID: dict[str, object] = {"motor": "rigid"}


def times_real_time(text: str, seconds: float, options: dict[str, object] | None = None) -> float:
    """How often real time `text` runs, over so many seconds of the module's time; the best of three."""
    best = 0.0
    for _ in range(3):
        bench = Bench(options)
        bench.sap(5, 512_000)
        started(text, bench)
        bench.run(2.0)
        began_s = time.process_time()
        bench.run(seconds)
        bench.gap(1)
        best = max(best, seconds / (time.process_time() - began_s))
        assert bench.state.truth.lost_fullsteps == 0
    return best


def _row(what: str, text: str, seconds: float, required_x: float, options: dict[str, object] | None = None) -> Row:
    speed = times_real_time(text, seconds, options)
    return Row(
        what=what,
        measured=f"{speed:,.0f} s per s",
        peer="real time",
        ratio=speed,
        required=f">= {required_x:g}",
        ok=speed >= required_x,
    )


def _speeds(quick: bool) -> list[Row]:
    seconds = 20.0 if quick else 100.0
    commands = times_real_time(COUNTING, 10 * seconds) * 1e6 / Bench().module.options.command_us
    turning, polling = (times_real_time(text, seconds / 4) for text in (TURNING, THERE_AND_BACK))
    return [
        Row(
            what="TMCL interpreter: commands on registers and variables",
            measured=f"{commands:,.0f}/s",
            peer=f"{COMMANDS_PER_S:,.0f}/s",
            ratio=commands / COMMANDS_PER_S,
            required=">= 1",
            ok=commands >= COMMANDS_PER_S,
        ),
        _row("TMCL loop that polls the position: motor at rest", AT_REST, 10 * seconds, LOOPS_X),
        _row("the same, rigid motor moving", THERE_AND_BACK, 10 * seconds, LOOPS_X, RIGID),
        _row("TMCL program that waits for positions: rigid motor", WAITING, 10 * seconds, LOOPS_X, RIGID),
        _row("the same, motor with physics", WAITING, seconds / 4, MOVING_X),
        Row(
            what="TMCL loop that polls the position: motor with physics",
            measured=f"{polling:,.0f} s per s",
            peer=f"the motor alone {turning:,.0f}",
            ratio=turning / polling,
            required=f"<= {POLLING_COST:g}, >= {MOVING_X:g} x real time",
            ok=turning / polling <= POLLING_COST and polling >= MOVING_X,
        ),
    ]


def _random(quick: bool) -> list[Row]:
    count = PROGRAMS // 10 if quick else PROGRAMS
    kinds: Sequence[tuple[str, Callable[[int, Bench], None], tuple[dict[str, object], ...]]] = (
        ("random TMCL programs, interrupts among them, as the oracle runs them", agree, ({}, LATER)),
        ("TMCL memories of random bytes: run on or stop with a reason", any_bytes, (LATER,)),
    )
    rows = []
    for what, check, modules in kinds:
        wrong = []
        benches = [Bench(options) for options in modules]
        began_s = time.perf_counter()
        for seed in range(count):
            try:
                check(seed, benches[seed % len(benches)])
            except AssertionError as error:
                wrong.append(str(error))
        took_s = time.perf_counter() - began_s
        rows.append(
            Row(
                what=what,
                measured=f"{count - len(wrong):,}",
                peer=f"{count:,}",
                ratio=(count - len(wrong)) / count,
                required="all",
                ok=not wrong,
                notes=(f"in {took_s:.0f} s", *wrong[:3]),
            )
        )
    return rows


def long_program() -> str:
    """2,048 lines with labels, jumps, comments and a constant: 2,047 commands."""
    lines = [
        f"L{at}: GGP {at % 256}, 2\n CALC ADD, {at} // one more\n JC NE, L{at // 8 * 4}\n SAP 4, 0, Speed"
        for at in range(0, 2044, 4)
    ]
    return "\n".join(("Speed = 51200", *lines, "STOP\nSTOP\nSTOP"))


def _assembler() -> Row:
    text = long_program()
    took_s = []
    for _ in range(9):
        began_s = time.perf_counter()
        made = assemble(text, INSTRUCTIONS)
        took_s.append(time.perf_counter() - began_s)
        assert len(made.commands) == 2047
        assert not made.problems
    best_s = min(took_s)
    return Row(
        what="assemble 2,048 lines of TMCL",
        measured=f"{best_s * 1e3:.1f} ms",
        peer=f"{ASSEMBLY_S * 1e3:g} ms",
        ratio=best_s / ASSEMBLY_S,
        required="< 1",
        ok=best_s < ASSEMBLY_S,
    )


def measure(quick: bool) -> list[Row]:
    """All rows; quick: shorter, and a tenth of the programs."""
    return [*_speeds(quick), *_random(quick), _assembler()]
