"""Names and units that the register rows of TMC428 and TMC4210 share: both have the same ramp generator."""

from __future__ import annotations

from ..build import RW, R, Rows, choice, flag
from ..model import Access, Field, Register

VELOCITY_UNIT = "fCLK/(65536*2^pulse_div) Hz"
ACCELERATION_UNIT = "fCLK^2/2^(pulse_div+ramp_div+29) Hz/s"
DIVIDER_UNIT = "fCLK/32/2^n"

RAMP_MODES = {0: "RAMP_MODE", 1: "SOFT_MODE", 2: "VELOCITY_MODE", 3: "HOLD_MODE"}
INVERTED = {0: "as is", 1: "inverted"}
ENABLED_DISABLED = {0: "stops", 1: "ignored"}

INTERRUPTS = (
    ("POS_END", "the target position was reached"),
    ("REF_WRONG", "the reference switch was active outside dx_ref_tolerance"),
    ("REF_MISS", "the reference switch was inactive at position zero"),
    ("STOP", "a switch forced a stop during motion"),
    ("STOP_LEFT_LOW", "the left switch went from high to low"),
    ("STOP_RIGHT_LOW", "the right switch went from high to low"),
    ("STOP_LEFT_HIGH", "the left switch went from low to high"),
    ("STOP_RIGHT_HIGH", "the right switch went from low to high"),
)


def interrupt_fields(upper_case: bool) -> tuple[Field, ...]:
    """The eight flags (write 1 to clear) and their eight masks, in the letter case of the chip's data sheet."""

    def spelled(name: str) -> str:
        return name.upper() if upper_case else name.lower()

    flags = tuple(
        Field(spelled(f"INT_{name}"), 1, f"{what}; write 1 to clear", lsb=bit, access=Access.R_W1C)
        for bit, (name, what) in enumerate(INTERRUPTS)
    )
    masks = tuple(
        flag(8 + bit, spelled(f"MASK_{name}"), f"lets the flag be set when {what}")
        for bit, (name, what) in enumerate(INTERRUPTS)
    )
    return flags + masks


def divider_fields(upper_case: bool) -> tuple[Field, Field]:
    """ramp_div and pulse_div, in the letter case of the chip's data sheet."""
    ramp, pulse = ("RAMP_DIV", "PULSE_DIV") if upper_case else ("ramp_div", "pulse_div")
    return (
        Field(ramp, 4, "pre-divider of the ramp clock: scales acceleration", unit=DIVIDER_UNIT, range=(0, 13), lsb=8),
        Field(pulse, 4, "pre-divider of the pulse clock: scales velocity", unit=DIVIDER_UNIT, range=(0, 13), lsb=12),
    )


def reference_fields(upper_case: bool) -> tuple[Field, ...]:
    """Ramp mode, the four switch bits and the latch bit of `lp & ref_conf & ramp_mode`."""
    mode, left, right, soft = ("RAMP_MODE", "disable_stop_l", "disable_stop_r", "soft_stop")
    reference = "ref_RnL"
    if not upper_case:
        mode, left, right, soft, reference = ("rm", "DISABLE_STOP_L", "DISABLE_STOP_R", "SOFT_STOP", "REF_RnL")
    return (
        choice(0, mode, 2, "how the ramp generator finds its velocity", RAMP_MODES),
        choice(8, left, 1, "whether the left switch stops motion to the left", ENABLED_DISABLED),
        choice(9, right, 1, "whether the right switch stops motion to the right", ENABLED_DISABLED),
        choice(10, soft, 1, "how a switch stops the motor", {0: "at once", 1: "with the linear ramp"}),
        choice(11, reference, 1, "which switch is the reference switch", {0: "left", 1: "right"}),
        choice(16, "lp", 1, "a position latch is armed and waits for the switch", {0: "idle", 1: "waiting"}, access=R),
    )


def position_compare(name: str, source: str, interrupt: str, interrupt_source: str) -> tuple[Register, Register]:
    """The position that is compared, and the interrupt that it raises."""
    row = Rows("position compare", source)
    return (
        row(0x35, name, 24, RW, "position at which the compare interrupt is raised").having(
            signed=True, unit="microsteps"
        ),
        row(
            0x36, interrupt, 9, RW, "position compare interrupt and its mask", volatile=True, source=interrupt_source
        ).having(
            Field("I", 1, "the compare position was met; write 1 to clear", lsb=0, access=Access.R_W1C),
            flag(8, "M", "lets the flag be set and raise the interrupt"),
        ),
    )
