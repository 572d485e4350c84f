"""Global parameters, ports and coordinates of the PD42-1241 (SGP, GGP; SIO, GIO; SCO, GCO). Sources: see `pd42`."""

from __future__ import annotations

from ..model import Access, Register, Space, Stored, to_raw
from .pd42_axis import INT32, ON_OFF

COORDINATES = 21
VARIABLES, VARIABLES_STORED = 256, 56

_EDGES = {0: "off", 1: "low to high", 2: "high to low", 3: "both"}


def _gp(
    space: Space,
    number: int,
    name: str,
    group: str,
    access: Access,
    limits: tuple[int, int],
    help_: str,
    *,
    unit: str = "",
    reset: int | None = None,
    values: dict[int, str] | None = None,
    stored: Stored = "",
    volatile: bool = False,
    section: str = "5.1",
    note: str = "",
) -> Register:
    return Register(
        name=name,
        width=32,
        help=help_,
        signed=limits[1] < 1 << 31,
        unit=unit,
        range=limits,
        values=values or {},
        address=number,
        access=access,
        reset=None if reset is None else to_raw(reset, 32),
        group=group,
        source=f"FM-PD42-1241 {section}",
        volatile=volatile or access is Access.R,
        space=space,
        stored=stored,
        write_note=note,
    )


def _bank0(
    number: int,
    name: str,
    group: str,
    limits: tuple[int, int],
    help_: str,
    *,
    unit: str = "",
    reset: int | None = None,
    values: dict[int, str] | None = None,
    note: str = "",
) -> Register:
    return _gp(
        Space.GLOBAL_0,
        number,
        name,
        group,
        Access.RW,
        limits,
        help_,
        unit=unit,
        reset=reset,
        values=values,
        stored="auto",
        note=note,
    )


_POWER_CYCLE = "in force after the next power-on"
_LOSES_CONTACT = "in force at once: the connection has to use the new address"
GLOBAL_PARAMETERS = (
    _bank0(
        65,
        "serial_baud_rate",
        "interface",
        (0, 11),
        "baud rate of the serial interface",
        note=_POWER_CYCLE,
        values={
            0: "9600",
            1: "14400",
            2: "19200",
            3: "28800",
            4: "38400",
            5: "57600",
            6: "76800",
            7: "115200",
            8: "230400",
            9: "250000",
            10: "500000",
            11: "1000000",
        },
        reset=0,
    ),
    _bank0(66, "serial_address", "interface", (1, 255), "address of the module", reset=1, note=_LOSES_CONTACT),
    _bank0(
        68,
        "serial_heartbeat",
        "interface",
        (0, 65535),
        "the motor stops when no command came for so long; 0 switches it off",
        unit="ms",
        reset=0,
    ),
    _bank0(
        69,
        "can_bit_rate",
        "interface",
        (2, 8),
        "bit rate of the CAN interface",
        reset=8,
        note=_POWER_CYCLE,
        values={
            2: "20 kbit/s",
            3: "50 kbit/s",
            4: "100 kbit/s",
            5: "125 kbit/s",
            6: "250 kbit/s",
            7: "500 kbit/s",
            8: "1 Mbit/s",
        },
    ),
    _bank0(70, "can_send_id", "interface", (0, 2047), "CAN identifier of the answers", reset=2),
    _bank0(71, "can_receive_id", "interface", (0, 2047), "CAN identifier that the module listens to", reset=1),
    _bank0(75, "telegram_pause_time", "interface", (0, 255), "pause before an answer on RS485", unit="ms", reset=0),
    _bank0(76, "serial_host_address", "interface", (0, 255), "first byte of every answer", reset=2),
    _bank0(77, "auto_start_mode", "application", (0, 1), "1 starts the program at power-on", values=ON_OFF, reset=0),
    _bank0(
        81,
        "tmcl_code_protection",
        "application",
        (0, 3),
        "what nobody may do with the program",
        values={0: "nothing", 1: "read", 2: "overwrite", 3: "read and overwrite"},
        reset=0,
        note="lifting the protection from reading erases the program",
    ),
    _bank0(82, "can_heartbeat", "interface", (0, 65535), "as parameter 68, for CAN", unit="ms", reset=0),
    _bank0(
        83, "can_secondary_address", "interface", (0, 2047), "second CAN identifier that the module listens to", reset=0
    ),
    _bank0(
        84,
        "coordinate_storage",
        "application",
        (0, 1),
        "where coordinates are kept",
        values={0: "RAM", 1: "RAM and EEPROM"},
        reset=0,
    ),
    _bank0(
        85,
        "do_not_restore_user_variables",
        "application",
        (0, 1),
        "1: variables 0..55 are 0 at power-on",
        values={0: "restore", 1: "zero"},
        reset=0,
    ),
    _bank0(
        87,
        "serial_secondary_address",
        "interface",
        (0, 255),
        "second address, obeyed but never answered; 0 switches it off",
        reset=0,
    ),
    _gp(
        Space.GLOBAL_0,
        128,
        "tmcl_application_status",
        "application",
        Access.R,
        (0, 3),
        "what the program does",
        values={0: "stopped", 1: "runs", 2: "steps", 3: "reset"},
    ),
    _gp(
        Space.GLOBAL_0,
        129,
        "download_mode",
        "application",
        Access.R,
        (0, 1),
        "1 while commands are stored instead of done",
    ),
    _gp(Space.GLOBAL_0, 130, "tmcl_program_counter", "application", Access.R, (0, 65535), "which command is done now"),
    _gp(Space.GLOBAL_0, 131, "last_tmcl_error", "application", Access.R, (0, 255), "known by name alone"),
    _gp(
        Space.GLOBAL_0,
        132,
        "tmcl_tick_timer",
        "application",
        Access.RW,
        (0, (1 << 31) - 1),
        "counts milliseconds; may be set",
        unit="ms",
        volatile=True,
    ),
    _gp(
        Space.GLOBAL_0,
        133,
        "random_number",
        "application",
        Access.RW,
        (0, (1 << 31) - 1),
        "another number each time; writing it sets the seed",
        volatile=True,
    ),
    _gp(
        Space.GLOBAL_0,
        255,
        "suppress_reply",
        "interface",
        Access.RW,
        (0, 1),
        "1: only GAP, GGP and GIO are answered",
        values=ON_OFF,
        reset=0,
        note="with 1, a write can no longer be told from a lost one",
    ),
    *(
        _gp(
            Space.GLOBAL_2,
            number,
            f"user_variable_{number}",
            "variables",
            Access.RW,
            INT32,
            "for programs and for you",
            reset=0,
            stored="on request" if number < VARIABLES_STORED else "",
            section="5.3",
        )
        for number in range(VARIABLES)
    ),
    *(
        _gp(
            Space.GLOBAL_3,
            number,
            f"timer_{number}_period",
            "interrupts",
            Access.RW,
            (0, (1 << 32) - 1),
            "interval of the timer interrupt",
            unit="ms",
            reset=0,
            section="5.4",
        )
        for number in range(3)
    ),
    *(
        _gp(
            Space.GLOBAL_3,
            number,
            f"{name}_trigger_transition",
            "interrupts",
            Access.RW,
            (0, 3),
            "edges that interrupt",
            values=_EDGES,
            reset=0,
            section="5.4",
        )
        for number, name in (
            (27, "stop_left"),
            (28, "stop_right"),
            (39, "input_0"),
            (40, "input_1"),
            (41, "input_2"),
            (42, "input_3"),
        )
    ),
)


def _port(
    space: Space,
    number: int,
    name: str,
    access: Access,
    limits: tuple[int, int],
    help_: str,
    unit: str = "",
    section: str = "3.6.13",
    reset: int | None = None,
    values: dict[int, str] | None = None,
) -> Register:
    group = "inputs/outputs"
    return _gp(
        space, number, name, group, access, limits, help_, unit=unit, section=section, reset=reset, values=values
    )


PORTS = (
    _port(Space.DIGITAL_IN, 0, "in0_home", Access.R, (0, 1), "digital input 0, also the home switch"),
    _port(Space.DIGITAL_IN, 1, "in1", Access.R, (0, 1), "digital input 1, also of the encoder or step/direction"),
    _port(Space.DIGITAL_IN, 2, "in2", Access.R, (0, 1), "digital input 2; to be left open in step/direction mode"),
    _port(Space.DIGITAL_IN, 3, "in3", Access.R, (0, 1), "the analog input, read as a digital one"),
    _port(Space.ANALOG_IN, 0, "ain0", Access.R, (0, 4095), "analog input", "ADC counts"),
    _port(Space.ANALOG_IN, 8, "supply_voltage", Access.R, (0, 1000), "supply, as the sister module tells it", "0.1 V"),
    _port(
        Space.ANALOG_IN, 9, "temperature", Access.R, (-128, 127), "of the module, as the sister module tells it", "degC"
    ),
    _port(
        Space.PULL_UP,
        0,
        "input_pull_ups",
        Access.W,
        (0, 3),
        "pull-up resistors: 1 at the home input, 2 at inputs 1 and 2, 3 at all",
        section="3.6.12",
        reset=3,
        values={0: "none", 1: "home input", 2: "inputs 1 and 2", 3: "all"},
    ),
    _port(Space.OUTPUT, 0, "out0", Access.RW, (0, 1), "open drain output", section="3.6.12", reset=0),
    _port(
        Space.OUTPUT,
        1,
        "out1",
        Access.RW,
        (0, 1),
        "second output: PyTrinamic names it, the manual has one",
        section="3.6.12",
        reset=0,
    ),
)

COORDINATE_ROWS = tuple(
    _gp(
        Space.COORDINATE,
        number,
        f"coordinate_{number}",
        "coordinates",
        Access.RW,
        INT32,
        "a position that MVP COORD goes to",
        unit="microsteps",
        reset=0,
        stored="on request" if number else "",
        section="3.6.22",
    )
    for number in range(COORDINATES)
)
