"""Global parameters, ports and coordinates of the PD42-1241 (SGP, GGP; SIO, GIO; SCO, GCO). Sources: see `pd42`."""

from __future__ import annotations

from ..build import OFF_ON, RW, R, W
from ..model import Space
from .build import Parameters
from .pd42_axis import INT32, MANUAL

COORDINATES = 21
VARIABLES, VARIABLES_STORED = 256, 56

_BAUD_RATES = dict(
    enumerate(map(str, (9600, 14400, 19200, 28800, 38400, 57600, 76800, 115200, 230400, 250000, 500000, 1000000)))
)
_CAN_BIT_RATES = {
    **{code: f"{kbit} kbit/s" for code, kbit in enumerate((20, 50, 100, 125, 250, 500), 2)},
    8: "1 Mbit/s",
}
_EDGES = {0: "off", 1: "low to high", 2: "high to low", 3: "both"}

_interface = Parameters("interface", f"{MANUAL} 5.1", Space.GLOBAL_0, stored="auto")
_application = Parameters("application", f"{MANUAL} 5.1", Space.GLOBAL_0, stored="auto")
_reply = Parameters("interface", f"{MANUAL} 5.1", Space.GLOBAL_0)
_state = Parameters("application", f"{MANUAL} 5.1", Space.GLOBAL_0)
_variables = Parameters("variables", f"{MANUAL} 5.3", Space.GLOBAL_2)
_interrupts = Parameters("interrupts", f"{MANUAL} 5.4", Space.GLOBAL_3)
_coordinates = Parameters("coordinates", f"{MANUAL} 3.6.22", Space.COORDINATE)
_POWER_CYCLE = "in force after the next power-on"
_LOSES_CONTACT = "in force at once: the connection has to use the new address"
GLOBAL_PARAMETERS = (
    _interface(65, "serial_baud_rate", RW, (0, 11), "baud rate of the serial interface").having(
        write_note=_POWER_CYCLE,
        values=_BAUD_RATES,
        reset=0,
    ),
    _interface(66, "serial_address", RW, (1, 255), "address of the module", reset=1, write_note=_LOSES_CONTACT),
    _interface(
        68,
        "serial_heartbeat",
        RW,
        (0, 65535),
        "the motor stops when no serial command came for so long; 0 switches it off",
    ).having(unit="ms", reset=0),
    _interface(69, "can_bit_rate", RW, (2, 8), "bit rate of the CAN interface").having(
        reset=8,
        write_note=_POWER_CYCLE,
        values=_CAN_BIT_RATES,
    ),
    _interface(70, "can_send_id", RW, (0, 2047), "CAN identifier of the answers", reset=2),
    _interface(71, "can_receive_id", RW, (0, 2047), "CAN identifier that the module listens to", reset=1),
    _interface(75, "telegram_pause_time", RW, (0, 255), "pause before an answer on RS485", unit="ms", reset=0),
    _interface(76, "serial_host_address", RW, (0, 255), "first byte of every answer", reset=2),
    _application(77, "auto_start_mode", RW, (0, 1), "1 starts the program at power-on", values=OFF_ON, reset=0),
    _application(81, "tmcl_code_protection", RW, (0, 3), "what nobody may do with the program").having(
        values={0: "nothing", 1: "read", 2: "overwrite", 3: "read and overwrite"},
        reset=0,
        write_note="lifting the protection from reading erases the program",
    ),
    _interface(
        82,
        "can_heartbeat",
        RW,
        (0, 65535),
        "the motor stops when no command came over CAN for so long; 0 switches it off",
    ).having(unit="ms", reset=0),
    _interface(
        83, "can_secondary_address", RW, (0, 2047), "second CAN identifier, obeyed but never answered; 0: none"
    ).having(reset=0),
    _application(84, "coordinate_storage", RW, (0, 1), "where coordinates are kept").having(
        values={0: "RAM", 1: "RAM and EEPROM"}, reset=0
    ),
    _application(85, "do_not_restore_user_variables", RW, (0, 1), "1: variables 0..55 are 0 at power-on").having(
        values={0: "restore", 1: "zero"}, reset=0
    ),
    _interface(
        87, "serial_secondary_address", RW, (0, 255), "second address, obeyed but never answered; 0 switches it off"
    ).having(reset=0),
    _state(128, "tmcl_application_status", R, (0, 3), "what the program does").having(
        values={0: "stopped", 1: "runs", 2: "steps", 3: "reset"}
    ),
    _state(129, "download_mode", R, (0, 1), "1 while commands are stored instead of done"),
    _state(130, "tmcl_program_counter", R, (0, 65535), "which command is done now"),
    _state(131, "last_tmcl_error", R, (0, 255), "known by name alone"),
    _state(132, "tmcl_tick_timer", RW, (0, (1 << 31) - 1), "counts milliseconds; may be set").having(
        unit="ms", volatile=True
    ),
    _state(133, "random_number", RW, (0, (1 << 31) - 1), "another number each time; writing it sets the seed").having(
        volatile=True
    ),
    _reply(255, "suppress_reply", RW, (0, 1), "1: only GAP, GGP and GIO are answered").having(
        values=OFF_ON, reset=0, write_note="with 1, a write can no longer be told from a lost one"
    ),
    *(
        _variables(number, f"user_variable_{number}", RW, INT32, "for programs and for you").having(
            reset=0, stored="on request" if number < VARIABLES_STORED else ""
        )
        for number in range(VARIABLES)
    ),
    *(
        _interrupts(number, f"timer_{number}_period", RW, (0, (1 << 32) - 1), "interval of the timer interrupt").having(
            unit="ms", reset=0
        )
        for number in range(3)
    ),
    *(
        _interrupts(number, f"{name}_trigger_transition", RW, (0, 3), "edges that interrupt", values=_EDGES, reset=0)
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


_input = Parameters("inputs/outputs", f"{MANUAL} 3.6.13", Space.DIGITAL_IN)
_analog = Parameters("inputs/outputs", f"{MANUAL} 3.6.13", Space.ANALOG_IN)
_output = Parameters("inputs/outputs", f"{MANUAL} 3.6.12", Space.OUTPUT)
_pull_up = Parameters("inputs/outputs", f"{MANUAL} 3.6.12", Space.PULL_UP)
PORTS = (
    _input(0, "in0_home", R, (0, 1), "digital input 0, also the home switch"),
    _input(1, "in1", R, (0, 1), "digital input 1, also of the encoder or step/direction"),
    _input(2, "in2", R, (0, 1), "digital input 2; to be left open in step/direction mode"),
    _input(3, "in3", R, (0, 1), "the analog input, read as a digital one"),
    _analog(0, "ain0", R, (0, 4095), "analog input", unit="ADC counts"),
    _analog(8, "supply_voltage", R, (0, 1000), "supply, as the sister module tells it", unit="0.1 V"),
    _analog(9, "temperature", R, (-128, 127), "of the module, as the sister module tells it", unit="degC"),
    _pull_up(
        0, "input_pull_ups", W, (0, 3), "pull-up resistors: 1 at the home input, 2 at inputs 1 and 2, 3 at all"
    ).having(reset=3, values={0: "none", 1: "home input", 2: "inputs 1 and 2", 3: "all"}),
    _output(0, "out0", RW, (0, 1), "open drain output", reset=0),
    _output(1, "out1", RW, (0, 1), "second output: PyTrinamic names it, the manual has one", reset=0),
)

COORDINATE_ROWS = tuple(
    _coordinates(number, f"coordinate_{number}", RW, INT32, "a position that MVP COORD goes to").having(
        unit="microsteps", reset=0, stored="on request" if number else ""
    )
    for number in range(COORDINATES)
)
