"""The registers of one axis by what they do, whatever the chip's data sheet calls them."""

from __future__ import annotations

from dataclasses import dataclass

from ...registers.model import Field, Register, RegisterTable

POSITIONING_MODES = (0, 1)
"""RAMP_MODE and SOFT_MODE: the chip drives to x_target by itself."""
RAMP_MODE, SOFT_MODE, VELOCITY_MODE, HOLD_MODE = range(4)


@dataclass(frozen=True, slots=True)
class AxisRoles:
    """Rows and fields of one axis of a ramp generator that TMC428 and TMC4210 share."""

    x_target: Register
    x_actual: Register
    v_min: Register
    v_max: Register
    v_target: Register
    v_actual: Register
    a_max: Register
    a_actual: Register
    proportionality: Register
    """pmul and pdiv."""
    reference: Register
    """Ramp mode, switch bits, latch bit."""
    interrupts: Register
    dividers: Register
    tolerance: Register
    x_latched: Register
    mode: Field
    stop_left_off: Field
    stop_right_off: Field
    reference_right: Field
    latch_waiting: Field
    pmul: Field
    pdiv: Field
    pulse_div: Field
    ramp_div: Field
    usrs: Field | None

    @classmethod
    def of(
        cls, table: RegisterTable, axis: int, reference: str, dividers: str, interrupts: str, mode: str
    ) -> AxisRoles:
        """Registers of `axis` by role; the four names are those that differ between the chips' data sheets."""
        reference_row, dividers_row = table.get(reference, axis), table.get(dividers, axis)
        proportionality = table.get("pmul_pdiv", axis)
        return cls(
            x_target=table.get("x_target", axis),
            x_actual=table.get("x_actual", axis),
            v_min=table.get("v_min", axis),
            v_max=table.get("v_max", axis),
            v_target=table.get("v_target", axis),
            v_actual=table.get("v_actual", axis),
            a_max=table.get("a_max", axis),
            a_actual=table.get("a_actual", axis),
            proportionality=proportionality,
            reference=reference_row,
            interrupts=table.get(interrupts, axis),
            dividers=dividers_row,
            tolerance=table.get("dx_ref_tolerance", axis),
            x_latched=table.get("x_latched", axis),
            mode=field_of(reference_row, mode),
            stop_left_off=field_of(reference_row, "disable_stop_l"),
            stop_right_off=field_of(reference_row, "disable_stop_r"),
            reference_right=field_of(reference_row, "ref_RnL"),
            latch_waiting=field_of(reference_row, "lp"),
            pmul=field_of(proportionality, "pmul"),
            pdiv=field_of(proportionality, "pdiv"),
            pulse_div=field_of(dividers_row, "pulse_div"),
            ramp_div=field_of(dividers_row, "ramp_div"),
            usrs=dividers_row.field_named("usrs"),
        )

    def with_mode(self, reference_word: int, mode: int) -> int:
        """The word to write for another ramp mode, the switch bits as they are."""
        return self.mode.pack(mode, over=reference_word) & self.reference.write_mask


def field_of(register: Register, name: str) -> Field:
    """The field of that name. Raises KeyError."""
    found = register.field_named(name)
    if found is None:
        raise KeyError(f"{register.name} has no field {name}")
    return found
