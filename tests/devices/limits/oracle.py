"""What the words that reached a chip mean, reckoned from the data sheets' formulas alone: nothing of `devices.limits`.

A chip is a dictionary of words, as after power-on and as each frame changes it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from app.calc.tmc5xxx.coil import CurrentStage
from app.calc.units.tmc5xxx import acceleration_unit_pps2, velocity_unit_pps
from app.calc.units.tmc428 import acceleration_hz_s, pulse_rate_hz
from app.devices.core.axis_limits import AxisLimits
from app.links.datagram_uart import UartForm
from app.links.tmcl import Request
from app.registers.catalog import CHIPS_32, MODELS
from app.registers.model import Register, Space
from app.registers.tmcl.commands import Opcode
from app.registers.tmcl.modules import MODULES

CLOCK_HZ = 16e6


class Meaning(NamedTuple):
    """Something that a chip holds: what it is, of which axis, how much."""

    quantity: str
    name: str
    axis: int
    value: float


class Oracle:
    """One chip of `model`."""

    def __init__(self, model: str, limits: AxisLimits) -> None:
        self.model, self.limits = model, limits
        self.table = MODELS[model].table
        self.words = {
            register.address: register.reset or 0
            for register in self.table
            if register.access.writable and not register.when
        }

    def heard(self, frames: list[bytes]) -> None:
        """Frames reached the chip."""
        for frame in frames:
            for address, word in self._writes(frame):
                self.words[address] = word

    def _writes(self, frame: bytes) -> Iterator[tuple[int, int]]:
        if self.model in CHIPS_32:
            if not frame[0] & 1:
                yield frame[0] >> 1, int.from_bytes(frame[1:], "big")
        elif self.model in MODULES:
            request = Request.decode(frame)
            if request.opcode == Opcode.SAP and self._takes(request.type, request.value):
                yield request.type, request.value
            elif request.opcode in (Opcode.ROR, Opcode.ROL):
                yield 2, request.value if request.opcode == Opcode.ROR else -request.value
            elif request.opcode == Opcode.MVP and request.type == 0:
                yield 0, request.value
        elif MODELS[self.model].uart_alone:
            if UartForm().is_write(frame):
                yield UartForm().register_of(frame), int.from_bytes(frame[3:7], "big")
        elif MODELS[self.model].spi is not None:
            datagram = int.from_bytes(frame, "big") & 0xF_FFFF
            tag = datagram >> 17
            yield (8 | tag, datagram & 0x1_FFFF) if tag & 4 else (8, datagram & 0x3_FFFF)
        elif frame[0] & 0x80:
            yield frame[0] & 0x7F, int.from_bytes(frame[1:], "big")

    def _takes(self, number: int, value: int) -> bool:
        """Whether the module may take a parameter, in either of its unit modes."""
        row = self.table.at(number, Space.AXIS)
        ranges = [] if row is None else [(row.minimum, row.maximum), row.internal_range or (0, -1)]
        return any(low <= value <= high for low, high in ranges)

    def beyond(self) -> list[Meaning]:
        """Everything that is beyond the limits."""
        most = {
            "velocity": self.limits.velocity_max_pps,
            "acceleration": self.limits.acceleration_max_pps2,
            "current": self.limits.current_max_a,
        }
        found = []
        for meaning in self.meanings():
            if meaning.quantity == "position":
                if self.limits.beyond(int(meaning.value)):
                    found.append(meaning)
                continue
            limit = most[meaning.quantity]
            if limit is not None and meaning.value > limit * (1 + 1e-6):
                found.append(meaning)
        return found

    def meanings(self) -> Iterator[Meaning]:
        """Everything that the chip holds."""
        for axis in range(MODELS[self.model].axes):
            if self.model in CHIPS_32:
                yield from self._ramp(axis)
            elif self.model == "tmc4361":
                yield from self._s_ramp()
            elif self.model in MODULES:
                yield from self._module()
            elif not MODELS[self.model].counts_position:
                yield from self._stepped()
            else:
                yield from self._sixpoint(axis)

    def row(self, name: str, axis: int = 0) -> Register:
        return self.table.get(name, axis)

    def value(self, name: str, axis: int = 0) -> int:
        row = self.row(name, axis)
        return row.decode(self.words[row.address])

    def _positions(self, axis: int, *names: str) -> Iterator[Meaning]:
        for name in names:
            yield Meaning("position", name, axis, self.value(name, axis))

    def _ramp(self, axis: int) -> Iterator[Meaning]:
        dividers = self.row("PULSE_DIV_RAMP_DIV" if self.model == "tmc4210" else "pulse_div_ramp_div_usrs", axis)
        fields = {name.casefold(): value for name, value in dividers.unpack(self.words[dividers.address]).items()}
        pulse, ramp = min(13, fields["pulse_div"]), min(13, fields["ramp_div"])
        for name in ("v_max", "v_min", "v_target", "v_actual"):
            velocity = abs(self.value(name, axis)) * pulse_rate_hz(1, pulse, CLOCK_HZ)
            yield Meaning("velocity", name, axis, velocity)
        yield Meaning(
            "acceleration", "a_max", axis, self.value("a_max", axis) * acceleration_hz_s(1, pulse, ramp, CLOCK_HZ)
        )
        yield from self._positions(axis, "x_target", "x_actual")

    def _sixpoint(self, axis: int) -> Iterator[Meaning]:
        clock_hz = 12.5e6 if self.model == "tmc5240" else CLOCK_HZ
        for name in ("VMAX", "VSTART", "VSTOP"):
            yield Meaning("velocity", name, axis, self.value(name, axis) * velocity_unit_pps(clock_hz))
        further = ("A2", "D2") if self.model == "tmc5240" else ()
        for name in ("AMAX", "DMAX", "A1", "D1", *further):
            yield Meaning("acceleration", name, axis, self.value(name, axis) * acceleration_unit_pps2(clock_hz))
        yield from self._positions(axis, "XTARGET", "XACTUAL")
        currents = self.row("IHOLD_IRUN", axis).unpack(self.words[self.row("IHOLD_IRUN", axis).address])
        if self.model == "tmc5240":
            yield self._ranged(currents)
            return
        if self.model == "tmc5160":
            select = self.value("GLOBAL_SCALER") or 256
            select = max(select, 32)
        else:
            chopconf = self.row("CHOPCONF", axis)
            select = chopconf.unpack(self.words[chopconf.address])["vsense"]
        stage = CurrentStage(self.model, self.limits.sense_resistor_ohm)
        scale = max(currents["IRUN"], currents["IHOLD"])
        yield Meaning("current", "IHOLD_IRUN", axis, stage.setting(scale, select).peak_a / math.sqrt(2))

    def _ranged(self, currents: dict[str, int]) -> Meaning:
        share = (11.75 / 36, 24 / 36, 1.0, 1.0)[self.value("DRV_CONF") & 3]
        share *= max(self.value("GLOBAL_SCALER") or 256, 32) / 256 * (max(currents["IRUN"], currents["IHOLD"]) + 1)
        return Meaning("current", "IHOLD_IRUN", 0, share / 32 * (self.limits.current_full_scale_a or 0.0))

    def _stepped(self) -> Iterator[Meaning]:
        if MODELS[self.model].can("own_velocity"):
            unit_pps = MODELS[self.model].clock_hz_default / (1 << 24)
            yield Meaning("velocity", "VACTUAL", 0, abs(self.value("VACTUAL")) * unit_pps)
        if MODELS[self.model].spi is not None:
            scale, conf = self.words[0xE] & 0x1F, self.words[0xF]
            peak_a = (
                (scale + 1) / 32 * (0.165 if conf >> 6 & 1 else 0.310) / (self.limits.sense_resistor_ohm or math.nan)
            )
            yield Meaning("current", "SGCSCONF", 0, peak_a / math.sqrt(2))
            return
        currents = self.row("IHOLD_IRUN").unpack(self.words[self.row("IHOLD_IRUN").address])
        if self.model == "tmc2240":
            yield self._ranged(currents)
            return
        resistor_ohm = self.limits.sense_resistor_ohm
        assert resistor_ohm is not None
        vsense = self.row("CHOPCONF").unpack(self.words[self.row("CHOPCONF").address])["vsense"]
        volts = 0.18 if vsense else 0.32 if self.model == "tmc2130" else 0.325
        peak_a = (max(currents["IRUN"], currents["IHOLD"]) + 1) / 32 * volts / (resistor_ohm + 0.02)
        yield Meaning("current", "IHOLD_IRUN", 0, peak_a / math.sqrt(2))

    def _s_ramp(self) -> Iterator[Meaning]:
        told_hz = self.value("CLK_FREQ")
        faster = CLOCK_HZ / told_hz if told_hz else math.inf
        direct = self.row("GENERAL_CONF").unpack(self.words[self.row("GENERAL_CONF").address])["direct_acc_val_en"]
        unit = CLOCK_HZ**2 / 2**37 if direct else faster**2 / 4
        for name in ("VMAX", "VSTART", "VSTOP"):
            yield Meaning("velocity", name, 0, abs(self.value(name)) / 256 * faster)
        for name in ("AMAX", "DMAX", "ASTART", "DFINAL", "DSTOP"):
            yield Meaning("acceleration", name, 0, (self.value(name) & 0xFF_FFFF) * unit)
        start = self.row("START_CONF").unpack(self.words[self.row("START_CONF").address])
        if start["pipeline_en[0]"]:
            yield from self._positions(0, *(f"X_PIPE{stage}" for stage in range(8)))
        # What a start would bring into VMAX and AMAX, by any way of using the shadow registers.
        option = start["shadow_option"]
        for number, name in ((0, "velocity"), (1, "acceleration"), *(((7, "velocity"),) if option else ())):
            row = self.row(f"SH_REG{number}")
            word = self.words[row.address]
            signed = word - (1 << 32) if name == "velocity" and word >> 31 else word
            value = abs(signed) / 256 * faster if name == "velocity" else (word & 0xFF_FFFF) * unit
            yield Meaning(name, row.name, 0, value)
        yield from self._positions(0, "XTARGET", "XACTUAL")

    def _module(self) -> Iterator[Meaning]:
        speeds: Sequence[int]
        rates: Sequence[int]
        if MODULES[self.model].counting == "unit mode":
            pps = self.words.get(255, 1) != 0
            one, one2 = (1.0, 1.0) if pps else (CLOCK_HZ / 2**24, CLOCK_HZ**2 / 2**41)
            speeds, rates, scaler = (2, 4, 19, 20, 194, 195), (5, 15, 17, 18), self.words.get(178, 0)
        else:
            pulse, ramp = self.words.get(154, 0), self.words.get(153, 0)
            one, one2 = CLOCK_HZ / 2 ** (16 + pulse), CLOCK_HZ**2 / 2 ** (29 + pulse + ramp)
            speeds, rates, scaler = (2, 4, 130, 194, 195), (5,), 0
        for number in speeds:
            yield Meaning("velocity", f"ap{number}", 0, abs(self.words.get(number, 0)) * one)
        for number in rates:
            yield Meaning("acceleration", f"ap{number}", 0, self.words.get(number, 0) * one2)
        for number in (0, 1):
            yield Meaning("position", f"ap{number}", 0, self.words.get(number, 0))
        full_scale_a = self.limits.current_full_scale_a
        assert full_scale_a is not None
        for number in (6, 7):
            share = self.words.get(number, 0) / 255 * ((scaler or 256) / 256)
            yield Meaning("current", f"ap{number}", 0, share * full_scale_a)
