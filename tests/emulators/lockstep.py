"""Runs an emulated chip and the oracle side by side and compares everything that can be seen."""

from __future__ import annotations

import random
from collections.abc import Iterable

from app.emulators.tmc428 import kernel
from app.emulators.tmc428.options import EmulatorOptions, StageOptions, SwitchChange, Wiring
from app.emulators.tmc428.stage import force
from app.emulators.tmc428.tmc428 import Tmc428
from app.emulators.tmc428.tmc4210 import Tmc4210
from tests.emulators.oracle import Oracle

VOLATILE = (0x1, 0x4, 0x5, 0x7, 0xB, 0xE)


class Pair:
    """One chip twice. Writes and switches go to both; `check` compares."""

    def __init__(self, step_dir: bool, wiring: Wiring, stages: Iterable[StageOptions], seed: int = 1) -> None:
        stages = list(stages)
        options = EmulatorOptions(seed=seed, wiring=wiring, stages=stages, driver_microsteps=16)
        self.chip = Tmc4210(options) if step_dir else Tmc428(options)
        ram = self.chip.ram if isinstance(self.chip, Tmc428) else []
        self.oracle = Oracle(1 if step_dir else 3, wiring, ram, step_dir)
        units = 16 if step_dir else 64
        for axis, stage in zip(self.oracle.axes, stages, strict=True):
            axis.left_at = round(stage.left_at_fullsteps * units)
            axis.right_at = round(stage.right_at_fullsteps * units)
            axis.ref_from = round(stage.ref_from_fullsteps * units)
            axis.ref_to = round(stage.ref_to_fullsteps * units)
            axis.place = round(stage.start_fullsteps * units)
        self.oracle.settle()
        self.clock = 0
        self.log: list[str] = []

    def run(self, clocks: int) -> None:
        self.clock += clocks
        self.chip.advance(self.clock)
        self.oracle.run_to(self.clock)

    def write(self, address: int, data: int) -> None:
        self.log.append(f"{self.clock}: write {address:#04x} {data:#x}")
        status = self.chip.exchange(address << 25 | data, self.clock) >> 24
        assert status == self.oracle_status(), self.report("status")
        self.oracle.write(address, data)

    def force(self, axis: int, name: str, active: int | None) -> None:
        self.log.append(f"{self.clock}: force {axis} {name} {active}")
        wanted = {name: "auto" if active is None else bool(active)}
        force(self.chip.axes[axis], SwitchChange.model_validate({"axis": axis, **wanted}))
        self.chip.refresh()
        forced = self.oracle.axes[axis].forced
        forced.pop(name, None)
        if active is not None:
            forced[name] = active
        self.oracle.settle()

    def oracle_status(self) -> int:
        waiting = 0
        if isinstance(self.chip, Tmc428):
            waiting = 0x40 if self.chip.chip[kernel.CW] or self.chip.chip[kernel.CAPTURE] in (1, 2) else 0
        return self.oracle.status() | waiting

    def report(self, what: str) -> str:
        return f"{what} differs at clock {self.clock} (tick {self.clock / 32})\n" + "\n".join(self.log[-60:])

    def check(self) -> None:
        addresses = [axis << 4 | register for axis in range(len(self.oracle.axes)) for register in VOLATILE]
        addresses += [0x0F, 0x36, 0x3E] if self.oracle.step_dir else [0x3E]
        for address in addresses:
            reply = self.chip.exchange(address << 25 | 1 << 24, self.clock)
            assert reply & 0xFFFFFF == self.oracle.read(address), self.report(f"register {address:#04x}")
            assert reply >> 24 == self.oracle_status(), self.report("status")
        for axis, plain in zip(self.chip.axes, self.oracle.axes, strict=True):
            assert axis[kernel.MECH] == plain.place, self.report("place")
            assert axis[kernel.LP] == plain.armed, self.report("lp")
            assert axis[kernel.SEQ] == plain.wave, self.report("sequencer")
            assert axis[kernel.ACC] == plain.accumulator, self.report("accumulator")
            assert axis[kernel.V8] == plain.v8, self.report("hidden velocity bits")
        if isinstance(self.chip, Tmc428):
            assert self.chip.chip[kernel.SENT_COUNT] == self.oracle.datagrams, self.report("datagrams sent")
            assert self.chip.describe_chain().last_bits == self.oracle.last_bits, self.report("datagram")
        else:
            described = self.chip.describe_step_dir(0)
            assert described.steps_sent == self.oracle.pulses, self.report("pulses")
            assert described.steps_merged == self.oracle.merged, self.report("merged pulses")


class Chaos:
    """Draws registers, modes, switches and moments; `seed` decides everything."""

    def __init__(self, seed: int, dividers: tuple[int, int], step_dir: bool = False) -> None:
        self.a_max = 100
        self.random = random.Random(seed)
        self.dividers = dividers
        draw = self.random
        stages = []
        for _ in range(1 if step_dir else 3):
            left = draw.randint(-60, -1)
            right = draw.randint(1, 60)
            reference = draw.randint(left - 2, right)
            stages.append(
                StageOptions(
                    left_at_fullsteps=float(left),
                    right_at_fullsteps=float(right),
                    ref_from_fullsteps=float(reference),
                    ref_to_fullsteps=float(reference + draw.randint(0, 8)),
                    start_fullsteps=float(draw.randint(left, right)),
                )
            )
        wirings: tuple[Wiring, ...] = ("left-only", "two-one-null", "multiplexed")
        self.pair = Pair(step_dir, draw.choice(wirings), stages, seed)
        for axis in range(len(stages)):
            for register in (0x2, 0x3, 0x6, 0x8, 0x9, 0xC, 0xA, 0x0, 0xB):
                self.write_axis(axis, register)
        if step_dir:
            self.pair.write(0x34, draw.choice((0x20, 0x20, 0x24, 0x30, 0x21, 0x00)))
        elif draw.random() < 0.7:
            self.pair.write(0x3F, 0x100702 | draw.getrandbits(1) << 16)

    def word(self, register: int) -> int:
        draw = self.random
        low, high = self.dividers
        match register:
            case 0x0:
                return (
                    draw.choice((draw.randint(-3000, 3000), draw.randint(-90, 90), 0, draw.getrandbits(24))) & 0xFFFFFF
                )
            case 0x1:
                return draw.choice((0, draw.randint(-90, 90), draw.choice((0x7FFFF0, 0x800010)))) & 0xFFFFFF
            case 0x2:
                return draw.choice((0, 1, draw.randint(0, 20), draw.randint(0, 2047)))
            case 0x3:
                return draw.choice((0, 2047, draw.randint(1, 300), draw.randint(0, 2047)))
            case 0x4 | 0x5:
                return (
                    draw.choice((0, 1, -1, -2048, 2047, draw.randint(-2047, 2047), draw.randint(-2047, 2047))) & 0xFFF
                )
            case 0x6:
                return draw.choice((0, 1, 2047, draw.randint(1, 60), draw.randint(0, 2047), draw.randint(0, 2047)))
            case 0x8:
                return draw.getrandbits(24)
            case 0x9:
                return (
                    draw.choice((draw.randint(0, 13), draw.randint(2, 8), draw.randint(5, 15)))
                    | draw.getrandbits(7) << 8
                )
            case 0xA:
                return draw.choice((0, 0, 1, 2, 3)) | (draw.getrandbits(4) & draw.getrandbits(4)) << 8
            case 0xB:
                return draw.getrandbits(16) | draw.choice((0, 0xFF00))
            case 0xC:
                return draw.randint(low, high) << 12 | draw.randint(low, high) << 8 | draw.randint(0, 7)
            case 0xD:
                return draw.choice((0, 1, draw.randint(0, 100)))
            case _:
                return draw.getrandbits(24)

    def write_axis(self, axis: int, register: int) -> None:
        self.pair.write(axis << 4 | register, self.word(register))

    def disturb(self) -> None:
        """One change on the fly."""
        draw = self.random
        pair = self.pair
        axes = len(pair.oracle.axes)
        axis = draw.randrange(axes)
        kind = draw.random()
        if kind < 0.75:
            registers = (
                0x0,
                0x0,
                0x0,
                0x1,
                0x2,
                0x3,
                0x4,
                0x4,
                0x5,
                0x5,
                0x6,
                0x8,
                0x9,
                0xA,
                0xA,
                0xB,
                0xC,
                0xD,
                0xE,
                0xE,
            )
            self.write_axis(axis, draw.choice(registers))
        elif kind < 0.9:
            pair.force(axis, draw.choice(("left", "right", "reference")), draw.choice((0, 1, None, None)))
        elif pair.oracle.step_dir:
            address = draw.choice((0x34, 0x35, 0x36, 0x3F, 0x0F))
            word = {
                0x34: draw.getrandbits(9) & ~2 | draw.choice((0, 0x20, 0x20)),
                0x35: draw.randint(-90, 90) & 0xFFFFFF,
                0x36: draw.choice((0x100, 0x101, 1, 0)),
                0x3F: draw.randint(0, 15) << 8 | draw.getrandbits(1) << 21,
                0x0F: draw.getrandbits(8),
            }
            pair.write(address, word[address])
        else:
            parameters = draw.getrandbits(7) & ~3 | draw.randint(0, 2) | draw.choice((0, 7, 9, 15, 255)) << 8
            parameters |= draw.getrandbits(1) << 16 | draw.choice((0, 1, 1)) << 20 | draw.getrandbits(1) << 21
            pair.write(0x3F, parameters)
            if draw.random() < 0.3:
                pair.write(0x40 | draw.randrange(64), draw.getrandbits(14))

    def play(self, base_ticks: int, rounds: int) -> None:
        """Spend about `base_ticks` in `rounds`, with a change and a comparison at the end of each."""
        for _ in range(rounds):
            self.pair.run(max(1, int(self.random.expovariate(rounds / base_ticks) * 32)))
            self.pair.check()
            self.disturb()
            self.pair.check()


class Trips(Chaos):
    """Sensible settings instead of wild ones: whole ramps, cruising, braking into targets and switches."""

    def word(self, register: int) -> int:
        draw = self.random
        match register:
            case 0x0:
                return (
                    draw.choice((draw.randint(-6000, 6000), draw.randint(-800, 800), draw.getrandbits(24))) & 0xFFFFFF
                )
            case 0x1:
                return draw.choice((0, draw.randint(-900, 900), 0x7FFFC0)) & 0xFFFFFF
            case 0x2:
                return draw.choice((1, 1, 0, draw.randint(2, 30)))
            case 0x3:
                return draw.randint(200, 2047)
            case 0x6:
                self.a_max = draw.choice((draw.randint(20, 400), 2047))
                return self.a_max
            case 0x9:  # p = a_max / 128 at equal dividers, a little more or less
                p = self.a_max / 128 * draw.choice((0.8, 0.95, 0.99, 1.0, 1.02, 1.3))
                pdiv = max(0, min(13, next((n for n in range(14) if p * 2 ** (3 + n) >= 128), 13)))
                return pdiv | (max(0, min(127, int(p * 2 ** (3 + pdiv) + 0.5) - 128)) << 8)
            case 0xA:
                return draw.choice((0, 0, 0, 1, 2)) | draw.choice((0, 0, 4, 8)) << 8
            case 0xC:
                divider = draw.randint(*self.dividers)
                return divider << 12 | divider << 8 | draw.choice((4, 6, 6))
        return super().word(register)
