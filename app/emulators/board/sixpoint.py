"""What the firmware does with a TMC5xxx in the slot: sets it up, moves its motors, names registers as parameters.

Source: boards/TMC5031_eval.c, TMC5062_eval.c, TMC5072_eval.c, TMC5130_eval.c, TMC5160_eval.c and TMC5240_eval.c of
TMC-EvalSystem, and the register presets in the headers of TMC-API. Numbers are in the chip's own units: nothing is
converted but where a parameter is a velocity and the register a TSTEP. Each board answers the numbers that its own
file has, also where its chip has no such register or field, and refuses the others with status 3.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

from ...registers.model import Field, Register, RegisterTable, to_signed
from . import chopper
from .functions import Parameters, Read, Write
from .refusal import invalid_value, wrong_type
from .registers import ChipRegisters

POSITION, RIGHT, LEFT = 0, 1, 2
"""RAMPMODE."""
TSTEP_MAX = 0xF_FFFF
VELOCITY_BITS = 24
CHOPCONF, CURRENTS = 0x0001_01D5, 0x0007_1703
GCONF_AT, RAMPMODE_AT, CHOPCONF_AT, COOLCONF_AT, MRES_SHIFT = 0x00, 0x20, 0x6C, 0x6D, 24
VREF_START_MV, VREF_BELOW_MV = 2000, 2714
"""The reference voltage of the TMC5130's board, and what it has to be below."""
RESTORES = frozenset({"tmc5062"})
"""Boards on which parameter 4 counts only while they position, and a move goes at the VMAX before the rotation."""
MEASURED_S: Mapping[str, float] = MappingProxyType({"tmc5062": 0.025})
"""How often the firmware looks how far the motors have come [s]."""
USUALLY_MEASURED_S = 0.005
UNITS_MS = 1048.576
"""VACTUAL's unit, microsteps in 2^24 clocks of 16 MHz, in a millisecond."""
BOARD_IDS: Mapping[str, int] = MappingProxyType(
    {"tmc5031": 2, "tmc5062": 25, "tmc5072": 7, "tmc5130": 5, "tmc5160": 16, "tmc5240": 28}
)
"""What the boards call themselves (BoardAssignment.h)."""
PRESETS: Mapping[str, Mapping[str, int]] = MappingProxyType(
    {
        "tmc5031": {"IHOLD_IRUN": CURRENTS, "VHIGH": 0xFF_FFFF, "ENC_CONST": 0x1_0000, "CHOPCONF": CHOPCONF},
        "tmc5062": {"IHOLD_IRUN": CURRENTS, "VHIGH": 0xFF_FFFF, "ENC_CONST": 0x1_0000, "CHOPCONF": CHOPCONF},
        "tmc5072": {"IHOLD_IRUN": CURRENTS, "VHIGH": 0xFF_FFFF, "ENC_CONST": 0x1_0000, "CHOPCONF": CHOPCONF},
        "tmc5130": {"IHOLD_IRUN": CURRENTS, "ENC_CONST": 0x1_0000, "CHOPCONF": CHOPCONF},
        "tmc5160": {
            "GCONF": 0x8,
            "SHORT_CONF": 0x1_0606,
            "DRV_CONF": 0x8_0400,
            "IHOLD_IRUN": 0x0007_0A03,
            "TPOWERDOWN": 0xA,
            "VSTOP": 1,
            "ENC_CONST": 0x1_0000,
            "CHOPCONF": 0x0041_0153,
        },
        "tmc5240": {
            "GCONF": 0x8,
            "DRV_CONF": 0x20,
            "IHOLD_IRUN": 0x0007_0A03,
            "TPOWERDOWN": 0xA,
            "VSTOP": 10,
            "D1": 10,
            "D2": 10,
            "ENC_CONST": 0x1_0000,
            "OTW_OV_VTH": 0x0B92_0F25,
            "CHOPCONF": 0x0041_0153,
        },
    }
)
"""What the firmware writes after a reset; every other register that it may write gets zero."""
KEPT = ("MSLUT", "PWMCONF")
"""Beginnings of names of registers that it leaves alone, because the chip comes up with something sensible."""
PWMCONF_5072 = 0x0005_04C8
REGISTERS = MappingProxyType(
    {0: "XTARGET", 1: "XACTUAL", 5: "AMAX", 14: "SW_MODE", 15: "A1", 16: "V1", 17: "DMAX", 18: "D1", 19: "VSTART",
     20: "VSTOP", 21: "TZEROWAIT", 24: "VDCMIN", 209: "X_ENC", 210: "ENC_CONST"}
)  # fmt: skip
"""Parameters that are a whole register."""
VELOCITY_THRESHOLDS = MappingProxyType({22: "VCOOLTHRS", 23: "VHIGH", 182: "VCOOLTHRS"})
"""Of the chips with two axes."""
TSTEP_THRESHOLDS = MappingProxyType({23: "THIGH", 182: "TCOOLTHRS", 186: "TPWMTHRS"})
"""Of the chips with one axis: velocities here, times of a step there."""
FIELDS = MappingProxyType(
    {6: ("IHOLD_IRUN", "IRUN"), 7: ("IHOLD_IRUN", "IHOLD"), 28: ("CHOPCONF", "vhighfs"),
     33: ("GCONF", "I_scale_analog"), 34: ("GCONF", "internal_Rsense"), 162: ("CHOPCONF", "tbl"),
     163: ("CHOPCONF", "chm"), 164: ("CHOPCONF", "disfdcc"),
     167: ("CHOPCONF", "toff"), 168: ("COOLCONF", "seimin"), 169: ("COOLCONF", "sedn"), 170: ("COOLCONF", "semax"),
     171: ("COOLCONF", "seup"), 172: ("COOLCONF", "semin"), 173: ("COOLCONF", "sfilt"), 174: ("COOLCONF", "sgt"),
     179: ("CHOPCONF", "vsense"), 184: ("CHOPCONF", "rndtf"), 185: ("CHOPCONF", "sync")}
)  # fmt: skip
"""Parameters that are part of a register, where the chip has that."""
BITS: Mapping[str, Mapping[int, tuple[int, int]]] = MappingProxyType(
    {
        "tmc5072": {163: (CHOPCONF_AT, 1 << 13)},  # CHM's number turns RNDTF
        "tmc5130": {30: (RAMPMODE_AT, 3)},
        "tmc5160": {34: (0x04, 1 << 1), 35: (0x0B, 0xFF), 184: (CHOPCONF_AT, 1 << 13), 185: (CHOPCONF_AT, 0xF << 20)},
        "tmc5240": {34: (0x04, 1 << 1), 185: (CHOPCONF_AT, 0xF << 20)},
    }
)
"""Parameters that are bits of a register at an address, whatever the chip has there."""
NOT_IN_CHIP: Mapping[str, Mapping[str, int]] = MappingProxyType(
    {"tmc5031": {"VDCMIN": 0x33, "X_ENC": 0x39, "ENC_CONST": 0x3A}}
)
"""Addresses of the first motor that the firmware uses although nothing is there; the second one's are 0x20 on."""
ENCODER_BITS = ((1 << 3, 1 << 4), (1 << 6, 1 << 5))
"""GCONF's bits of each motor that give pins away, and to its encoder: parameter 211."""
SINGLE_FIELDS = (
    (27, "CHOPCONF", "vhighchm"),
    (33, "GCONF", "recalibrate"),
    (188, "PWMCONF", "PWM_AMPL"),
    (188, "PWMCONF", "PWM_OFS"),
    (204, "PWMCONF", "freewheel"),
)
"""Of the chips with one axis; where there are two for a number each chip has one of them."""
EIGHT_POINT_REGISTERS = MappingProxyType({22: "V2", 23: "D2", 24: "A2", 25: "TVMAX", 27: "VDCMIN"})
EIGHT_POINT_FIELDS = MappingProxyType(
    {28: ("CHOPCONF", "vhighchm"), 29: ("CHOPCONF", "vhighfs"), 173: ("SG4_THRS", "sg4_filt_en"),
     175: ("COOLCONF", "sfilt"), 176: ("COOLCONF", "sgt"), 184: ("SG4_THRS", "sg_angle_offset"),
     195: ("PWMCONF", "pwm_meas_sd_enable"), 196: ("PWMCONF", "pwm_dis_reg_stst"),
     212: ("DRV_CONF", "CURRENT_RANGE"), 216: ("OTW_OV_VTH", "OVERVOLTAGE_VTH"),
     217: ("OTW_OV_VTH", "OVERTEMPPREWARNING_VTH")}
)  # fmt: skip
EIGHT_POINT_READINGS = MappingProxyType(
    {193: ("PWM_SCALE", "PWM_SCALE_SUM"), 214: ("ADC_VSUPPLY_AIN", "ADC_AIN"), 215: ("ADC_VSUPPLY_AIN", "ADC_VSUPPLY")}
)
"""Of the board whose chip has ramps of eight points; it numbers several things otherwise than the others."""
SUPPLY_STEP, TEMPERATURE_ZERO = 32 * 3052, 2038
"""What the board takes the ADC for: 3.052 / 10 mV times 32, and 7.7 to a degree from there."""
READINGS = MappingProxyType(
    {8: ("RAMP_STAT", "position_reached"), 180: ("DRV_STATUS", "CS_ACTUAL"), 206: ("DRV_STATUS", "SG_RESULT")}
)
"""Parameters that can only be read."""


class SixPointBoard:
    """`BoardFunctions` for a chip of `model`, whose rows are in `table`. `reset_chip` is for power-on: its reset pin is
    not the board's."""

    driver = None
    measures_velocity = True

    def __init__(
        self, model: str, table: RegisterTable, axes: int, registers: ChipRegisters, reset_chip: Callable[[], None]
    ) -> None:
        self.board_id = BOARD_IDS[model]
        self.axes = tuple(SixPointAxis(model, table, axis, registers) for axis in range(axes))
        self._model = model
        self._table = table
        self._registers = registers
        self._reset_chip = reset_chip
        self._measured_every_s = MEASURED_S.get(model, USUALLY_MEASURED_S)
        self._measured_s = registers.at_s

    def power_on(self) -> None:
        """Chip and board got their supply together; the chip is set up."""
        self._reset_chip()
        self._set_up()

    def reset(self) -> None:
        """Set the chip up again. It goes on as it is while its first motor turns."""
        if self._registers.read(self._table.get("VACTUAL", 0).address) == 0:
            self._set_up()

    def _set_up(self) -> None:
        self._registers.forget()
        presets = PRESETS[self._model]
        for address in self._registers.writable:
            row = self._table.at(address, write=True)
            if row is None or row.name.startswith(KEPT):
                continue
            if row.name == "FACTORY_CONF":  # keeps the trim of the clock that was burnt in
                otp = self._table.get("OTP_READ")
                trim = otp.field_named("OTP_FCLKTRIM")
                word = self._registers.read(otp.address)
                self._registers.write(address, trim.unpack(word) if trim else 0)
            else:
                self._registers.write(address, presets.get(row.name, 0))
        for name, address in NOT_IN_CHIP.get(self._model, {}).items():
            for axis in self.axes:
                self._registers.write(address + axis.axis * 0x20, presets.get(name, 0))
        if self._model == "tmc5072":
            for axis in self.axes:
                self._registers.write(self._table.get("PWMCONF", axis.axis).address, PWMCONF_5072)

    def pass_time(self, until_s: float, chip_s: float) -> None:
        """What the firmware does unasked: it measures velocities. Of all the looks only the last two count."""
        every_s = self._measured_every_s
        last_s = math.floor(until_s / every_s + 1e-6) * every_s
        for at_s in (last_s - every_s, last_s):
            at_s = max(at_s, chip_s)  # the chip has no past to look at
            if at_s - self._measured_s > every_s - 1e-6:
                self._registers.at_s = at_s
                for axis in self.axes:
                    axis.measure(at_s - self._measured_s)
                self._measured_s = at_s

    def user_function(self, number: int, motor: int, value: int) -> int:
        """Command 144: pins of the board that the emulated one does not have."""
        del number, motor, value
        raise wrong_type()


class SixPointAxis(Parameters):
    """`AxisFunctions` of motor `axis`."""

    def __init__(self, model: str, table: RegisterTable, axis: int, registers: ChipRegisters) -> None:
        self.axis = axis
        self._model = model
        self._table = table
        self._registers = registers
        self._positioning = 0
        self._positioning_before = 0
        """VMAX before a rotation, where the board brings it back for the next move; 0 for none."""
        self._place, self._measured = 0, 0
        self._vref_mv = VREF_START_MV
        self._resistor = 3
        known: dict[int, tuple[Read, Write | None]] = {
            2: (self._reader("VMAX"), lambda value: self._write("VMAX", abs(value))),
            3: (lambda: to_signed(self._read("VACTUAL") & (1 << VELOCITY_BITS) - 1, VELOCITY_BITS), None),
            4: (lambda: self._positioning, self._set_positioning),
        }
        super().__init__(known)
        for number, name in REGISTERS.items():
            self._add_register(number, name)
        single = self._row("THIGH") is not None
        if single:
            for number, name in TSTEP_THRESHOLDS.items():
                self._parameters[number] = (partial(self._velocity, name), partial(self._set_velocity, name))
            self._add_stealth()
        else:
            for number, name in VELOCITY_THRESHOLDS.items():
                self._add_register(number, name)
        for number, (name, part) in FIELDS.items():
            self._add_field(number, name, part)
        for number, name, part in SINGLE_FIELDS if single else ():
            self._add_field(number, name, part)
        for number, (name, part) in READINGS.items():
            self._add_field(number, name, part)
            self._parameters[number] = (self._parameters[number][0], None)
        for number, (address, mask) in BITS.get(model, {}).items():
            self._parameters[number] = self._bits(address, mask)
        self._add_switches(model)
        # the TMC5031's board shows another register, which never changes
        self._parameters[29] = (lambda: 0 if model == "tmc5031" else self._measured, None)
        if self._row("V2") is not None:
            self._add_eight_points()
        self._parameters[140] = (self._resolution, self._set_resolution)
        self._add_chopper()
        self._parameters[181] = self._stall()
        if model == "tmc5130":
            self._parameters[9] = (lambda: self._vref_mv, self._set_vref)
        if not single:
            self._parameters[211] = (self._encoder_has_pins, self._give_pins)

    # --- motion ----------------------------------------------------------------------------------

    def rotate(self, velocity: int) -> None:
        if self._model in RESTORES and not self._positioning_before:
            self._positioning_before = self._read("VMAX")
        self._write("VMAX", abs(velocity))
        self._write("RAMPMODE", RIGHT if velocity >= 0 else LEFT)

    def move_to(self, position: int) -> None:
        if self._model in RESTORES:
            if self._positioning_before:
                self._write("VMAX", self._positioning_before)
                self._positioning_before = 0
            self._write("XTARGET", position)
            self._write("RAMPMODE", POSITION)
            return
        self._write("RAMPMODE", POSITION)
        self._write("VMAX", self._positioning)
        self._write("XTARGET", position)

    def move_by(self, distance: int) -> int:
        target = to_signed(self._read("XACTUAL") + distance & 0xFFFF_FFFF, 32)
        self.move_to(target)
        return target

    def measure(self, seconds: float) -> None:
        """How far it has come since the last time, `seconds` ago."""
        place = self._registers.signed(self._table.get("XACTUAL", self.axis).address)
        way = to_signed(place - self._place & 0xFFFF_FFFF, 32)
        self._place, self._measured = place, int(way / round(seconds * 1000) * UNITS_MS)

    # --- axis parameters -------------------------------------------------------------------------

    def _add_register(self, number: int, name: str) -> None:
        address = NOT_IN_CHIP.get(self._model, {}).get(name)
        if self._row(name) is not None:
            self._parameters[number] = (self._reader(name), partial(self._write, name))
        elif address is not None:
            address += self.axis * 0x20
            # an encoder position is asked from the chip, the others come from the firmware's memory
            read = (lambda: 0) if name == "X_ENC" else partial(self._registers.signed, address)
            self._parameters[number] = (read, partial(self._registers.write, address))

    def _add_eight_points(self) -> None:
        for number, name in EIGHT_POINT_REGISTERS.items():
            self._add_register(number, name)
        for number, (name, part) in EIGHT_POINT_FIELDS.items():
            self._add_field(number, name, part)
        for number, (name, part) in EIGHT_POINT_READINGS.items():
            self._add_field(number, name, part)
            self._parameters[number] = (self._parameters[number][0], None)
        self._parameters[26] = (partial(self._velocity, "THIGH"), partial(self._set_velocity, "THIGH"))
        self.measured_velocity = 30
        self._parameters[30] = (lambda: self._measured, None)
        self._parameters[35] = (self._reader("GLOBAL_SCALER"), self._set_scaler)
        self._parameters[174] = (
            lambda: to_signed(self._field("SG4_THRS", "SG4_THRS") & 0x7F, 7),
            partial(self._set_field, "SG4_THRS", "SG4_THRS"),
        )
        self._parameters[194] = (self._reader("MSCNT"), None)
        # which resistor the board puts to IREF: the emulated one has 12 kOhm whatever this says
        self._parameters[211] = (lambda: self._resistor, self._set_resistor)
        self._parameters[213] = (self._reader("ADC_TEMP"), None)
        supply, warning = partial(self._field, "ADC_VSUPPLY_AIN"), partial(self._field, "OTW_OV_VTH")
        self._parameters[218] = (lambda: 10 * (self._read("ADC_TEMP") - TEMPERATURE_ZERO) // 77, None)
        self._parameters[219] = (lambda: 3052 * supply("ADC_AIN") // 10_000, None)
        self._parameters[220] = (lambda: SUPPLY_STEP * supply("ADC_VSUPPLY") // 10_000, None)
        self._parameters[221] = (
            lambda: SUPPLY_STEP * warning("OVERVOLTAGE_VTH") // 10_000,
            lambda value: self._set_field("OTW_OV_VTH", "OVERVOLTAGE_VTH", value * 10_000 // SUPPLY_STEP),
        )
        self._parameters[222] = (
            lambda: int((warning("OVERTEMPPREWARNING_VTH") - TEMPERATURE_ZERO) / 7.7),
            lambda value: self._set_field("OTW_OV_VTH", "OVERTEMPPREWARNING_VTH", int(value * 7.7) + TEMPERATURE_ZERO),
        )
        self._parameters[223] = (lambda: 1, lambda _: None)  # the chip is never put to sleep

    def _set_scaler(self, value: int) -> None:
        self._write("GLOBAL_SCALER", value & 0xFF if value > 31 else 0)

    def _set_resistor(self, value: int) -> None:
        if 0 <= value <= 3:
            self._resistor = value

    def _bits(self, address: int, mask: int) -> tuple[Read, Write]:
        """Bits of a register of the first motor's, or of this one's."""
        if address >= CHOPCONF_AT:
            address += self.axis * 0x10
        elif address >= RAMPMODE_AT:
            address += self.axis * 0x20
        shift = (mask & -mask).bit_length() - 1
        registers = self._registers
        return (
            lambda: (registers.read(address) & mask) >> shift,
            lambda value: registers.change(address, mask, value << shift & mask),
        )

    def _add_chopper(self) -> None:
        """Numbers 165 and 166."""
        registers, address = self._registers, self._table.get("CHOPCONF", self.axis).address

        def through(read: chopper.Reader, write: chopper.Writer) -> tuple[Read, Write]:
            return (
                lambda: read(registers.read(address)),
                lambda value: registers.write(address, write(registers.read(address), value)),
            )

        self._parameters[165] = through(chopper.END_READ[self._model], chopper.END_WRITTEN[self._model])
        self._parameters[166] = through(chopper.START_READ[self._model], chopper.START_WRITTEN)

    def _set_vref(self, value: int) -> None:
        if not 0 <= value < VREF_BELOW_MV:
            raise invalid_value()
        self._vref_mv = value

    def _encoder_has_pins(self) -> int:
        others, own = ENCODER_BITS[self.axis]
        return int(self._registers.read(GCONF_AT) & (others | own) == own)

    def _give_pins(self, value: int) -> None:
        others, own = ENCODER_BITS[self.axis]
        self._registers.change(GCONF_AT, others | own, own if value else others)

    def _add_field(self, number: int, name: str, part: str) -> None:
        row = self._row(name)
        if row is None:
            return
        if not part:
            self._add_register(number, name)
        elif row.field_named(part) is not None:
            self._parameters[number] = (partial(self._field, name, part), partial(self._set_field, name, part))

    def _add_switches(self, model: str) -> None:
        """Inputs at rest read 1, but on a TMC5072; stops are switched on by 0 on two boards, by 1 on the others."""
        of_5072 = model == "tmc5072"
        inverted = model in ("tmc5031", "tmc5130")

        def level(side: str) -> int:
            return self._field("RAMP_STAT", f"status_stop_{side}") ^ (not of_5072)

        def enable(side: str, value: int) -> None:
            on = value == 0 if inverted else value > 0 if of_5072 else value & 1
            self._set_field("SW_MODE", f"stop_{side}_enable", int(on))
            if of_5072:
                self._set_field("SW_MODE", f"pol_stop_{side}", int(value == 2))

        for number, side in ((10, "r"), (11, "l")):
            self._parameters[number] = (partial(level, side), None)
            enabled = partial(self._field, "SW_MODE", f"stop_{side}_enable")
            self._parameters[number + 2] = (enabled, partial(enable, side))

    def _add_stealth(self) -> None:
        def gradient(value: int) -> None:
            self._set_field("PWMCONF", "PWM_GRAD", value)
            self._set_field("GCONF", "en_pwm_mode", int(value != 0))

        def limited(part: str, most: int, value: int) -> None:
            if not 0 <= value <= most:
                raise invalid_value()
            self._set_field("PWMCONF", part, value)

        self._parameters[187] = (partial(self._field, "PWMCONF", "PWM_GRAD"), gradient)
        for number, part, most in ((191, "pwm_freq", 3), (192, "pwm_autoscale", 1)):
            self._parameters[number] = (partial(self._field, "PWMCONF", part), partial(limited, part, most))

    def _stall(self) -> tuple[Read, Write]:
        """Stop on stall above a velocity, 0: never."""
        read, write = self._parameters[182]

        def stop_above(value: int) -> None:
            self._set_field("SW_MODE", "sg_stop", int(value != 0))
            if write is not None:
                write(value)

        return lambda: read() if self._field("SW_MODE", "sg_stop") else 0, stop_above

    def _set_positioning(self, velocity: int) -> None:
        self._positioning = abs(velocity)
        if self._read("RAMPMODE") == POSITION:
            self._write("VMAX", self._positioning)

    def _resolution(self) -> int:
        """Two boards look at a field that is not MRES."""
        at, shift = {"tmc5031": (COOLCONF_AT, MRES_SHIFT), "tmc5072": (CHOPCONF_AT, 0)}.get(
            self._model, (CHOPCONF_AT, MRES_SHIFT)
        )
        return 256 >> self._bits(at, 0xF << shift)[0]()

    def _set_resolution(self, microsteps: int) -> None:
        """What is no resolution is refused by the boards with one axis, and ignored by the others."""
        if microsteps not in (1 << power for power in range(9)):
            if self._row("THIGH") is not None:
                raise invalid_value()
            return
        for at in (CHOPCONF_AT, COOLCONF_AT) if self._model == "tmc5031" else (CHOPCONF_AT,):
            self._bits(at, 0xF << MRES_SHIFT)[1](9 - microsteps.bit_length())

    # --- registers by name ------------------------------------------------------------------------

    def _row(self, name: str) -> Register | None:
        try:
            return self._table.get(name, self.axis)
        except KeyError:
            return None

    def _part(self, name: str, part: str) -> tuple[Register, Field]:
        row = self._table.get(name, self.axis)
        field = row.field_named(part)
        if field is None:
            raise wrong_type()
        return row, field

    def _read(self, name: str) -> int:
        return self._registers.read(self._table.get(name, self.axis).address)

    def _reader(self, name: str) -> Read:
        return lambda: to_signed(self._read(name), 32)

    def _write(self, name: str, value: int) -> None:
        self._registers.write(self._table.get(name, self.axis).address, value)

    def _field(self, name: str, part: str) -> int:
        row, field = self._part(name, part)
        return field.unpack(self._registers.read(row.address))

    def _set_field(self, name: str, part: str, value: int) -> None:
        row, field = self._part(name, part)
        self._registers.change(row.address, field.mask, value << field.lsb & field.mask)

    def _velocity(self, name: str) -> int:
        return _step_time(self._read(name))

    def _set_velocity(self, name: str, value: int) -> None:
        self._write(name, _step_time(value))


def _step_time(value: int) -> int:
    """Between a velocity and the time of a step, either way, as the firmware does it."""
    return min(TSTEP_MAX, (1 << VELOCITY_BITS) // (value or 1))
