"""Programs that read the drive as they go: compiled together with it they do the same as command by command."""

from __future__ import annotations

import random

import pytest

from app.calc.tmcl.instructions import Command
from app.emulators.tmcl import beside_drive
from app.registers.tmcl.commands import Opcode
from tests.emulators.tmcl.harness import Bench
from tests.emulators.tmcl.programs import commands_of, download

NEAR: dict[str, object] = {
    "stage": {
        "left_at_fullsteps": -12.0,
        "right_at_fullsteps": 15.0,
        "home_from_fullsteps": 3.0,
        "home_to_fullsteps": 6.0,
    }
}
READ = (0, 1, 3, 4, 8, 9, 10, 11, 180, 206, 207, 250)


def _program(rng: random.Random) -> list[Command]:
    """Moves and loops that look at them, with interrupts by timers, switches and arrivals."""
    lines = ["SAP 5, 0, 200000", "SAP 12, 0, 0", f"SAP 4, 0, {rng.choice((2560, 10_240, 51_200))}"]
    lines += [f"VECT {number}, Irq" for number in (0, 3, 27, 28, 39)]
    lines += [f"SGP {number}, 3, {rng.randrange(4)}" for number in (27, 28, 39)]
    lines += [f"SGP 0, 3, {rng.choice((0, 3, 17))}", *(f"EI {rng.choice((0, 3, 27, 28, 39))}" for _ in range(3))]
    lines += ["EI 255"] * rng.randrange(2) + ["Loop:"]
    for at in range(rng.randrange(2, 9)):
        read = rng.choice(READ)
        lines += [
            rng.choice(
                (
                    f"MVP ABS, 0, {rng.randint(-4000, 4000)}",
                    f"MVP REL, 0, {rng.randint(-900, 900)}",
                    "MST 0",
                    f"ROR 0, {rng.choice((0, 900, 20_000))}",
                    f"WAIT TICKS, 0, {rng.randrange(3)}",
                    f"WAIT POS, 0, {rng.randrange(1, 4)}",
                    "CALC ADD, 7",
                )
            ),
            f"P{at}: GAP {read}, {rng.choice((0, 0, 0, 0, 1))}",
            f"COMP {rng.choice((0, 1, 500, -500))}",
            f"JC {rng.choice(('GT', 'NE', 'LT', 'EQ'))}, {rng.choice((f'P{at}', f'Q{at}', 'Loop'))}",
            f"AGP {at}, 2",
            f"Q{at}:",
        ]
    lines += ["JA Loop", "Irq: GGP 9, 2", "CALC ADD, 1", "AGP 9, 2", "GAP 1, 0", "AGP 10, 2", "MST 0", "RETI"]
    return commands_of("\n".join(lines))


def _seen(bench: Bench) -> tuple[object, ...]:
    state = bench.state
    at = state.application
    variables = bench.module._firmware.application.variables[:12].tolist()
    return (
        at.counter, at.accumulator, at.flags, at.status, at.error, at.interrupted, at.waits, variables,
        bench.gap(1), bench.gap(3), bench.gap(0), state.truth.rotor_rad,
    )  # fmt: skip


@pytest.mark.parametrize("motor", ["physics", "rigid"])
def test_compiled_with_the_drive_and_command_by_command_are_the_same(motor: str) -> None:
    options = {**NEAR, **({"motor": "rigid"} if motor == "rigid" else {})}
    for seed in range(12):
        rng = random.Random(seed)
        program = _program(rng)
        compiled, single = Bench(options), Bench(options)
        single.module._firmware.interpreter._here[:] = beside_drive.NOT_HERE
        for bench in (compiled, single):
            download(bench, program)
            bench.do(Opcode.RUN_APPLICATION, 1)
        for _ in range(8):
            seconds = rng.uniform(0.001, 0.12)
            compiled.run(seconds)
            single.run(seconds)
            assert _seen(compiled) == _seen(single), f"seed {seed}"


@pytest.mark.parametrize("model", ["pd42-1241", "tmcm-1161"])
def test_what_programs_and_hosts_read_is_the_same(model: str) -> None:
    bench = Bench(NEAR, model=model)
    bench.do(Opcode.ROR, 0, 0, 300)
    for number in beside_drive.READ_HERE:
        bench.run(0.03)
        download(bench, commands_of(f"GAP {number}, 0\nSTOP"))
        before = bench.gap(number)
        bench.do(Opcode.RUN_APPLICATION, 1)
        bench.run(0.0005)
        assert (
            min(before, bench.gap(number)) - 40 <= bench.do(Opcode.GET_STATUS, 2) <= max(before, bench.gap(number)) + 40
        )


def test_parameters_that_a_firmware_lacks_are_refused_in_programs_too() -> None:
    bench = Bench({"unknown_parameters": [206]})
    download(bench, commands_of("CALC LOAD, 5\nGAP 206, 0\nSTOP"))
    bench.do(Opcode.RUN_APPLICATION, 1)
    bench.run(0.01)
    assert (bench.do(Opcode.GET_STATUS, 2), bench.ggp(131)) == (5, 3)


def test_the_position_is_that_of_the_command_s_own_time() -> None:
    bench = Bench({"motor": "rigid"})
    bench.sap(5, 5_000_000)
    bench.do(Opcode.ROR, 0, 0, 51_200)
    bench.run(1.0)
    # Commands take 100 us: between the two readings are 4, in which it goes 20.48 microsteps.
    download(bench, commands_of("GAP 1, 0\nAGP 0, 2\nCALC ADD, 1\nCALC ADD, 1\nGAP 1, 0\nAGP 1, 2\nSTOP"))
    bench.do(Opcode.RUN_APPLICATION, 1)
    bench.run(1.0)
    assert 20 <= bench.ggp(1, 2) - bench.ggp(0, 2) <= 21
