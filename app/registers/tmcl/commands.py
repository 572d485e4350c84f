"""TMCL as rows: commands, status codes and flags, for driver, emulator, console and log alike.

Source "FM-PD42-1241" is the TMCL manual of the PD42-1241 (firmware V1.44). Its tables were lost in the copy
at hand; type and motor codes come from manuals and headers of sister modules, named in `source`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum, IntFlag
from types import MappingProxyType
from typing import Any

COORDINATES_IN_EEPROM = 255
"""As motor of SCO and GCO: copy between RAM and EEPROM (FM-PD42-1241 3.6.22 and 3.6.23)."""
CONTROL_FIRST = 128
"""Commands from here on are control commands: never stored in a program (FM-PD42-1241 3.6.36)."""
PROGRAM_COMMANDS = 2048
"""Length of the program memory [commands]: what the family's header and older manuals say."""
MAGIC = 1234
"""What factory settings and reset want as value, so that no slip of a byte causes them."""


class Opcode(IntEnum):
    """Command numbers (FM-PD42-1241 3.6); names of the control commands are ours."""

    ROR = 1
    ROL = 2
    MST = 3
    MVP = 4
    SAP = 5
    GAP = 6
    STAP = 7
    RSAP = 8
    SGP = 9
    GGP = 10
    STGP = 11
    RSGP = 12
    RFS = 13
    SIO = 14
    GIO = 15
    CALC = 19
    COMP = 20
    JC = 21
    JA = 22
    CSUB = 23
    RSUB = 24
    EI = 25
    DI = 26
    WAIT = 27
    STOP = 28
    SCO = 30
    GCO = 31
    CCO = 32
    CALCX = 33
    AAP = 34
    AGP = 35
    CLE = 36
    VECT = 37
    RETI = 38
    ACO = 39
    CALCVV = 40
    CALCVA = 41
    CALCAV = 42
    CALCVX = 43
    CALCXV = 44
    CALCV = 45
    MVPA = 46
    RST = 48
    DJNZ = 49
    ROLA = 50
    RORA = 51
    SIV = 55
    GIV = 56
    AIV = 57
    UF0 = 64
    UF1 = 65
    UF2 = 66
    UF3 = 67
    UF4 = 68
    UF5 = 69
    UF6 = 70
    UF7 = 71
    CALL = 80
    STOP_APPLICATION = 128
    RUN_APPLICATION = 129
    STEP_APPLICATION = 130
    RESET_APPLICATION = 131
    ENTER_DOWNLOAD = 132
    EXIT_DOWNLOAD = 133
    READ_MEMORY = 134
    GET_STATUS = 135
    GET_VERSION = 136
    FACTORY_DEFAULT = 137
    REQUEST_EVENT = 138
    BOOT = 242
    RESET_MODULE = 255


class Status(IntEnum):
    """Third byte of a reply (FM-PD42-1241 3.2.1)."""

    WRONG_CHECKSUM = 1
    INVALID_COMMAND = 2
    WRONG_TYPE = 3
    INVALID_VALUE = 4
    EEPROM_LOCKED = 5
    NOT_AVAILABLE = 6
    OK = 100
    STORED = 101
    EVENT = 128


STATUS_TEXTS: Mapping[int, str] = MappingProxyType(
    {
        Status.WRONG_CHECKSUM: "wrong checksum",
        Status.INVALID_COMMAND: "invalid command",
        Status.WRONG_TYPE: "wrong type",
        Status.INVALID_VALUE: "invalid value",
        Status.EEPROM_LOCKED: "configuration EEPROM locked",
        Status.NOT_AVAILABLE: "command not available",
        Status.OK: "done",
        Status.STORED: "stored in program memory",
        Status.EVENT: "position reached",
    }
)


EXTENDED_ERRORS = 207
"""The axis parameter that reading clears."""


class ExtendedErrors(IntFlag):
    """Axis parameter 207: what stopped the motor. Cleared by reading it, and by the next motion command."""

    STALL = 1
    DEVIATION = 2


class DriverErrors(IntFlag):
    """Axis parameter 208: bits 24..31 of the driver's DRV_STATUS."""

    STALL = 1
    OVERTEMPERATURE = 2
    OVERTEMPERATURE_WARNING = 4
    SHORT_A = 8
    SHORT_B = 16
    OPEN_LOAD_A = 32
    OPEN_LOAD_B = 64
    STANDSTILL = 128


@dataclass(frozen=True, slots=True)
class CommandRow:
    """One command, for the console and the log. `types` names the values of the type byte, where it has names."""

    opcode: int
    mnemonic: str
    """Empty for control commands, which have only numbers; `name` says what they are called here."""
    name: str
    help: str
    source: str
    types: Mapping[str, int] = field(default_factory=dict)
    type: str = ""
    """What the type byte means; empty where it has to be 0."""
    motor: str = ""
    value: str = ""
    reply: str = ""
    """What the value of the reply is; empty where it means nothing."""
    direct: bool = True
    """Whether it works in direct mode: some only work in programs."""
    moves: bool = False
    """Whether it may set a motor in motion or stop one."""
    reads: bool = False
    """Whether it only reads."""
    later: bool = False
    """Whether only firmware later than V1.44 knows it (manuals of the PD42-1240 V1.45 and of the TMCM-1290)."""

    @property
    def jumps(self) -> bool:
        """Whether the value of this command of a program is an address of the program."""
        return bool(self.mnemonic) and self.value == "address"

    def __post_init__(self) -> None:
        object.__setattr__(self, "types", MappingProxyType(dict(self.types)))


_MOTOR = "motor, 0"
_BANK = "bank, 0, 2 or 3"
_VARIABLE = "user variable, 0..255"
_COORDINATE = "coordinate, 0..20"
_MVP = {"ABS": 0, "REL": 1, "COORD": 2}
_RFS = {"START": 0, "STOP": 1, "STATUS": 2}
_CALC = {
    "ADD": 0, "SUB": 1, "MUL": 2, "DIV": 3, "MOD": 4, "AND": 5, "OR": 6, "XOR": 7, "NOT": 8, "LOAD": 9,
}  # fmt: skip
_CONDITIONS = {
    "ZE": 0, "NZ": 1, "EQ": 2, "NE": 3, "GT": 4, "GE": 5, "LT": 6, "LE": 7, "ETO": 8, "EAL": 9, "EDV": 10, "EPO": 11,
}  # fmt: skip
_WAITS = {"TICKS": 0, "POS": 1, "REFSW": 2, "LIMSW": 3, "RFS": 4}
_CALC_ANY = {**_CALC, "SWAP": 10, "COMP": 11}
_FLAGS = {"ALL": 0, "ETO": 1, "EAL": 2, "EDV": 3, "EPO": 4}


def _later(opcode: int, mnemonic: str, name: str, help_: str, **more: Any) -> CommandRow:
    return CommandRow(opcode, mnemonic, name, f"{help_} Later firmware only.", "TMCM-1290", later=True, **more)


COMMANDS: tuple[CommandRow, ...] = (
    CommandRow(1, "ROR", "rotate right", "Turn on and on, position counting up.", "FM-PD42-1241 3.6.1", motor=_MOTOR,
               value="velocity [pps]", moves=True),
    CommandRow(2, "ROL", "rotate left", "Turn on and on, position counting down.", "FM-PD42-1241 3.6.2", motor=_MOTOR,
               value="velocity [pps]", moves=True),
    CommandRow(3, "MST", "motor stop", "Slow down to a stop with the maximum acceleration.", "FM-PD42-1241 3.6.3",
               motor=_MOTOR, moves=True),
    CommandRow(4, "MVP", "move to position", "Go to a position by a ramp; answers at once.", "FM-PD42-1241 3.6.4", _MVP,
               "ABS, REL or COORD", _MOTOR, "position, distance or number of a coordinate", moves=True),
    CommandRow(5, "SAP", "set axis parameter", "Write an axis parameter (RAM).", "FM-PD42-1241 3.6.5",
               type="axis parameter", motor=_MOTOR, value="value", moves=True),
    CommandRow(6, "GAP", "get axis parameter", "Read an axis parameter.", "FM-PD42-1241 3.6.6", type="axis parameter",
               motor=_MOTOR, reply="value", reads=True),
    CommandRow(7, "STAP", "store axis parameter", "Copy an axis parameter to EEPROM, on modules that keep them there.",
               "PyTrinamic", type="axis parameter", motor=_MOTOR),
    CommandRow(8, "RSAP", "restore axis parameter", "Copy an axis parameter back from EEPROM, where STAP is known.",
               "PyTrinamic", type="axis parameter", motor=_MOTOR, moves=True),
    CommandRow(9, "SGP", "set global parameter", "Write a global parameter or user variable.", "FM-PD42-1241 3.6.7",
               type="parameter", motor=_BANK, value="value"),
    CommandRow(10, "GGP", "get global parameter", "Read a global parameter or user variable.", "FM-PD42-1241 3.6.8",
               type="parameter", motor=_BANK, reply="value", reads=True),
    CommandRow(11, "STGP", "store global parameter", "Copy a user variable, 0..55, to EEPROM.", "FM-PD42-1241 3.6.9",
               type="user variable", motor="bank, 2"),
    CommandRow(12, "RSGP", "restore global parameter", "Copy a user variable, 0..55, back from EEPROM.",
               "FM-PD42-1241 3.6.10", type="user variable", motor="bank, 2"),
    CommandRow(13, "RFS", "reference search", "Start, stop or ask for the built-in reference search.",
               "FM-PD42-1241 3.6.11",
               _RFS, "START, STOP or STATUS", _MOTOR, reply="STATUS: 0 when no search runs", moves=True),
    CommandRow(14, "SIO", "set output", "Switch an output, or the pull-ups of the inputs.", "FM-PD42-1241 3.6.12",
               type="port", motor="bank, 2 (outputs) or 0 (pull-ups)", value="0 or 1; pull-ups: bits"),
    CommandRow(15, "GIO", "get input", "Read an input, or what an output was set to.",
               "FM-PD42-1241 3.6.13", type="port",
               motor="bank, 0 digital, 1 analog, 2 outputs", reply="state or ADC counts", reads=True),
    CommandRow(19, "CALC", "calculate", "Calculate with accumulator and value.",
               "FM-PD42-1241 3.6.14", _CALC, "operation",
               value="operand", reply="operand"),
    CommandRow(20, "COMP", "compare", "Compare the accumulator with a value.", "FM-PD42-1241 3.6.15", value="value",
               direct=False),
    CommandRow(21, "JC", "jump conditional", "Jump where the condition holds.", "FM-PD42-1241 3.6.16", _CONDITIONS,
               "condition", value="address", direct=False),
    CommandRow(22, "JA", "jump always", "Jump.", "FM-PD42-1241 3.6.17", value="address", direct=False),
    CommandRow(23, "CSUB", "call subroutine", "Jump, and remember the way back.",
               "FM-PD42-1241 3.6.18", value="address",
               direct=False),
    CommandRow(24, "RSUB", "return from subroutine", "Go back to where the subroutine was called.",
               "FM-PD42-1241 3.6.19",
               direct=False),
    CommandRow(25, "EI", "enable interrupt", "Enable an interrupt; 255 all of them.", "FM-PD42-1241 3.6.30",
               type="interrupt, 255 for all"),
    CommandRow(26, "DI", "disable interrupt", "Disable an interrupt; 255 all of them.", "FM-PD42-1241 3.6.31",
               type="interrupt, 255 for all"),
    CommandRow(27, "WAIT", "wait", "Wait for time, position, switch or search.",
               "FM-PD42-1241 3.6.20", _WAITS, "condition",
               _MOTOR, "ticks of 10 ms, or time limit", direct=False),
    CommandRow(28, "STOP", "stop program", "End the program.", "FM-PD42-1241 3.6.21", direct=False),
    CommandRow(30, "SCO", "set coordinate", "Write a coordinate; motor 255 copies to EEPROM.", "FM-PD42-1241 3.6.22",
               type=_COORDINATE, motor="motor, 0; 255 for EEPROM", value="position"),
    CommandRow(31, "GCO", "get coordinate", "Read a coordinate; motor 255 copies from EEPROM.", "FM-PD42-1241 3.6.23",
               type=_COORDINATE, motor="motor, 0; 255 for EEPROM", reply="position", reads=True),
    CommandRow(32, "CCO", "capture coordinate", "Take the actual position as a coordinate.", "FM-PD42-1241 3.6.24",
               type=_COORDINATE, motor=_MOTOR, reply="position"),
    CommandRow(33, "CALCX", "calculate with X", "Calculate with accumulator and X register.", "FM-PD42-1241 3.6.26",
               {**_CALC, "SWAP": 10}, "operation"),
    CommandRow(34, "AAP", "accumulator to axis parameter", "Write the accumulator to an axis parameter.",
               "FM-PD42-1241 3.6.27", type="axis parameter", motor=_MOTOR, moves=True),
    CommandRow(35, "AGP", "accumulator to global parameter", "Write the accumulator to a global parameter.",
               "FM-PD42-1241 3.6.28", type="parameter", motor=_BANK),
    CommandRow(36, "CLE", "clear error flags", "Clear flags of the program interpreter.", "FM-PD42-1241 3.6.29", _FLAGS,
               "flag"),
    CommandRow(37, "VECT", "set interrupt vector", "Tell where an interrupt goes.",
               "FM-PD42-1241 3.6.32", type="interrupt",
               value="address", direct=False),
    CommandRow(38, "RETI", "return from interrupt", "Go back to what the interrupt interrupted.", "FM-PD42-1241 3.6.33",
               direct=False),
    CommandRow(39, "ACO", "accumulator to coordinate", "Write the accumulator to a coordinate.", "FM-PD42-1241 3.6.25",
               type=_COORDINATE, motor=_MOTOR),
    _later(40, "CALCVV", "calculate with two variables", "Calculate with two user variables, into the first.",
           types=_CALC_ANY, type="operation", motor=_VARIABLE, value="second user variable, 0..255"),
    _later(41, "CALCVA", "variable with accumulator", "Calculate with variable and accumulator, into the variable.",
           types=_CALC_ANY, type="operation", motor=_VARIABLE),
    _later(42, "CALCAV", "accumulator with variable", "Calculate with accumulator and variable, into the accumulator.",
           types=_CALC_ANY, type="operation", motor=_VARIABLE),
    _later(43, "CALCVX", "variable with X", "Calculate with user variable and X, into the variable.",
           types=_CALC_ANY, type="operation", motor=_VARIABLE),
    _later(44, "CALCXV", "X with variable", "Calculate with X and user variable, into X.",
           types=_CALC_ANY, type="operation", motor=_VARIABLE),
    _later(45, "CALCV", "calculate with variable", "Calculate with user variable and value, into the variable.",
           types={**_CALC, "COMP": 11}, type="operation", motor=_VARIABLE, value="operand", reply="operand"),
    _later(46, "MVPA", "move to accumulator", "Go where the accumulator says.", types=_MVP, type="ABS, REL or COORD",
           motor=_MOTOR, moves=True),
    _later(48, "RST", "restart program", "Clear stack and registers, and go on at an address.", value="address",
           direct=False),
    _later(49, "DJNZ", "decrement, jump if not zero", "Take one from a user variable, and jump while it is not 0.",
           type="user variable, 0..255", value="address", direct=False),
    _later(50, "ROLA", "rotate left by accumulator", "ROL at the accumulator's velocity.", motor=_MOTOR, moves=True),
    _later(51, "RORA", "rotate right by accumulator", "ROR at the accumulator's velocity.", motor=_MOTOR, moves=True),
    _later(55, "SIV", "set indexed variable", "Write the user variable whose number is in X.", value="value"),
    _later(56, "GIV", "get indexed variable", "Read the user variable whose number is in X into the accumulator."),
    _later(57, "AIV", "accumulator to indexed variable", "Write the accumulator to the variable whose number is in X."),
    _later(80, "CALL", "call subroutine conditional", "CSUB where the condition holds.", types=_CONDITIONS,
           type="condition", value="address", direct=False),
    *(
        CommandRow(64 + number, f"UF{number}", f"user function {number}",
                   "Reserved for functions of a customer's own firmware.", "FM-PD42-1241 3.6.34",
                   type="its own", motor="its own", value="its own", reply="its own", moves=True)
        for number in range(8)
    ),
    CommandRow(128, "", "stop application", "Stop the program in the module.", "FM-PD42-1241 3.6.36"),
    CommandRow(129, "", "run application", "Run the program in the module.", "FM-PD42-1241 3.6.36",
               {"CURRENT": 0, "ADDRESS": 1}, "from where", value="address for type 1", moves=True),
    CommandRow(130, "", "step application", "Do the next command of the program.", "FM-PD42-1241 3.6.36", moves=True),
    CommandRow(131, "", "reset application", "Stop the program and go to its start.", "FM-PD42-1241 3.6.36"),
    CommandRow(132, "", "enter download mode", "From now on store commands instead of doing them.",
               "FM-PD42-1241 3.6.36",
               value="address"),
    CommandRow(133, "", "exit download mode", "From now on do commands again.", "FM-PD42-1241 3.6.36"),
    CommandRow(134, "", "read program memory", "Read a stored command; the answer has no checksum.",
               "FM-PD42-1241 3.6.36",
               value="address", reply="the command", reads=True),
    CommandRow(135, "", "get application status", "What the program interpreter does.", "FM-PD42-1241 3.6.36",
               {"POINTER": 0, "COUNTER": 1, "ACCUMULATOR": 2, "X": 3}, "what", reply="by type", reads=True),
    CommandRow(136, "", "get firmware version", "Module and firmware; the string has no checksum.",
               "FM-PD42-1241 3.6.36",
               {"STRING": 0, "BINARY": 1}, "form", reply="module << 16 | version", reads=True),
    CommandRow(137, "", "restore factory settings", "Forget everything in EEPROM; not answered.", "FM-PD42-1241 3.6.36",
               value="1234"),
    CommandRow(138, "", "request position reached event", "Tell by a second answer when an MVP has arrived.",
               "FM-PD42-1241 3.6.35", {"NEXT": 0, "EVERY": 1}, "which MVP", value="bits of motors, 1",
               reply="bits of motors"),
    CommandRow(255, "", "reset module", "Start the module again, as after power-on.",
               "FM-PD42-1241 3.6.36", value="1234",
               moves=True),
)  # fmt: skip

INTERRUPT_NAMES: Mapping[str, int] = MappingProxyType(
    {
        "TI_TIMER0": 0, "TI_TIMER1": 1, "TI_TIMER2": 2, "TI_POSITION_REACHED": 3, "TI_STALL": 15, "TI_DEVIATION": 21,
        "TI_STOP_LEFT": 27, "TI_STOP_RIGHT": 28, "TI_INPUT0": 39, "TI_INPUT1": 40, "TI_INPUT2": 41, "TI_INPUT3": 42,
        "TI_GLOBAL": 255,
    }
)  # fmt: skip
"""Interrupts by name (numbers: TMCM-1290 manual, that of input 3 inferred from PyTrinamic's numbering of bank 3). The
manual shows TI_TIMER0 and TI_GLOBAL (FM-PD42-1241 3.5.6.4); the other names are ours."""

BY_OPCODE: Mapping[int, CommandRow] = MappingProxyType({row.opcode: row for row in COMMANDS})
BY_MNEMONIC: Mapping[str, CommandRow] = MappingProxyType({row.mnemonic: row for row in COMMANDS if row.mnemonic})

BAUD_RATES: Mapping[int, int] = MappingProxyType(
    {0: 9600, 1: 14400, 2: 19200, 3: 28800, 4: 38400, 5: 57600, 6: 76800, 7: 115200}
)
"""Global parameter 65 in bank 0 to baud (TMCM-1690 and TMCM-1290 manuals; higher codes are not confirmed)."""

CAN_BIT_RATES: Mapping[int, int] = MappingProxyType(
    {2: 20_000, 3: 50_000, 4: 100_000, 5: 125_000, 6: 250_000, 7: 500_000, 8: 1_000_000}
)
"""Global parameter 69 in bank 0 to bit/s (TMCM-1690 manual)."""

SWAPPED = 64
"""Added to a mode 1..4 of the reference search (axis parameter 193, FM-PD42-1241 7.1): it looks for the other side."""
HOME_INVERTED = 128
"""Added to a mode 5..8: it takes the home switch the other way round."""


def reference_modes() -> tuple[int, ...]:
    """Every value that axis parameter 193 takes."""
    return (*range(1, 9), *(mode + SWAPPED for mode in range(1, 5)), *(mode + HOME_INVERTED for mode in range(5, 9)))
