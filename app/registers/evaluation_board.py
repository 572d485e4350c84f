"""What Trinamic's Landungsbrücke is asked and answers: commands, boards and states as numbers.

A Landungsbrücke is the base board of Trinamic's evaluation kits: a USB serial port that speaks TMCL, with a
slot for a motion controller (channel 1) and one for a driver (channel 2). Source: its published firmware
(analogdevicesinc/TMC-EvalSystem, tmc/TMCL.c and tmc/BoardAssignment.h) and PyTrinamic, which asks it.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum
from types import MappingProxyType

ADDRESS = 1
"""Fixed: a Landungsbrücke answers nobody who asks another module."""
REGISTER_ADDRESS_BITS = 12
"""Of a register's address: eight in the type byte, the upper four in the upper half of the motor byte."""


class BoardOpcode(IntEnum):
    """Commands that modules do not have."""

    GET_IDS = 143
    USER_FUNCTION_MC = 144
    USER_FUNCTION_DRV = 145
    WRITE_MC = 146
    WRITE_DRV = 147
    READ_MC = 148
    READ_DRV = 149
    MEASURED_SPEED = 150
    BOARD_ERROR = 151
    BOARD_RESET = 152
    GET_INFO = 157


class BoardStatus(IntEnum):
    """Status codes that modules do not have."""

    LOAD_ERROR = 7
    WRITE_PROTECTED = 8
    MAX_EXCEEDED = 9
    READ_FAILED = 11
    DELAYED = 128


MODULE_NUMBERS: Mapping[int, str] = MappingProxyType({12: "Landungsbrücke", 16: "Startrampe", 26: "Landungsbrücke V3"})
"""What a board calls itself: the four digits before the V of `0012V312` (command 136, type 0)."""

CHANNEL_1_BOARDS: Mapping[int, str] = MappingProxyType(
    {1: "TMC5241", 2: "TMC5031", 4: "TMC4361", 5: "TMC5130", 6: "TMC5041", 7: "TMC5072", 11: "TMC4361A", 13: "TMC4671",
     16: "TMC5160", 25: "TMC5062", 28: "TMC5240", 29: "TMC5272", 30: "TMC5262", 31: "TMC5271"}
)  # fmt: skip
"""Boards in the slot of the motion controller, by what global parameter 4 and command 143 say in the lowest byte."""

CHANNEL_2_BOARDS: Mapping[int, str] = MappingProxyType(
    {1: "TMC2660", 3: "TMC2130", 4: "TMC2100", 6: "TMC2208", 7: "TMC2224", 8: "TMC2209", 11: "TMC2160",
     18: "TMC2225", 22: "TMC2226", 28: "TMC2240"}
)  # fmt: skip
"""Boards in the slot of the driver, by the third byte."""


class SlotState(IntEnum):
    """What is known of a slot: the second and the fourth byte."""

    DONE = 2
    NO_ANSWER = 4
