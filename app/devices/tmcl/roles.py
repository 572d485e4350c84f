"""Register roles: parameters of a module that the driver itself needs, by what they are for."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from ...registers.model import Register, Space
from ...registers.tmcl.description import TmclModule
from ...registers.tmcl.modules import MODULES
from .units import SCALINGS

NOWHERE = 0x100
"""Added to the number of a parameter that another module of the family has: of this one nothing answers there."""


class RegisterRoles:
    """Of one module. What its table lacks is in `absent`: a row of another module's table, that is never asked for."""

    def __init__(self, module: TmclModule) -> None:
        self.module = module
        self._absent: list[Register] = []
        row = self._finder()
        self.target_position = row("target_position")
        self.actual_position = row("actual_position")
        self.target_speed = row("target_speed")
        self.actual_speed = row("actual_speed")
        self.max_speed = row("maximum_positioning_speed")
        self.max_acceleration = row("maximum_acceleration")
        self.min_speed = row("minimum_speed")
        self.ramp_mode = row("ramp_mode")
        self.max_current = row("maximum_current")
        self.standby_current = row("standby_current")
        self.current_scaler = row("global_current_scaler")
        self.position_reached = row("position_reached_flag")
        self.home_switch = row("home_switch_state")
        self.right_switch = row("right_limit_switch_state")
        self.left_switch = row("left_limit_switch_state")
        self.right_disabled = row("right_limit_switch_disable")
        self.left_disabled = row("left_limit_switch_disable")
        self.right_inverted = row("right_limit_switch_polarity")
        self.left_inverted = row("left_limit_switch_polarity")
        self.switches_inverted = row("limit_switch_polarity")
        self.a1 = row("acceleration_a1")
        self.v1 = row("velocity_v1")
        self.max_deceleration = row("maximum_deceleration")
        self.d1 = row("deceleration_d1")
        self.vstart = row("velocity_vstart")
        self.vstop = row("velocity_vstop")
        self.ramp_wait = row("ramp_wait_time")
        self.measured_speed = row("measured_speed")
        self.microsteps = row("microstep_resolution")
        self.off_time = row("chopper_off_time")
        self.current_scale = row("smartenergy_actual_current")
        self.pwm_scale = row("pwm_scale")
        self.search_mode = row("reference_search_mode")
        self.search_speed = row("reference_search_speed")
        self.switch_speed = row("reference_switch_speed")
        self.switch_distance = row("end_switch_distance")
        self.last_reference = row("last_reference_position")
        self.full_steps = row("motor_fullstep_resolution")
        self.load = row("actual_load_value")
        self.extended_error_flags = row("extended_error_flags")
        self.driver_flags = row("driver_error_flags")
        self.encoder = row("encoder_position")
        self.encoder_prescaler = row("encoder_prescaler")
        self.max_deviation = row("maximum_encoder_deviation")
        self.absolute_encoder = row("absolute_encoder_value")
        self.external_encoder = row("external_encoder_position")
        self.external_resolution = row("external_encoder_resolution")
        self.external_max_deviation = row("external_encoder_maximum_deviation")
        self.reverse_shaft = row("reverse_shaft")
        self.shaft_direction = row("reverse_shaft_direction")
        self.step_direction = row("step_direction_mode")
        self.unit_mode = row("unit_mode")
        self.ticks = row("tmcl_tick_timer")
        self.program = (row("tmcl_application_status"), row("tmcl_program_counter"))
        """What tells whether a program runs, and where it is."""

        self.absent = tuple(self._absent)
        """Rows that this module does not have."""
        self.instead = {(self.actual_speed.space, self.actual_speed.address): self.measured_speed}
        """What to read in place of a row that a module's firmware has not: the speed by its encoder."""
        self.counting = tuple(module.table.get(name, 0) for name in SCALINGS[module.counting].names)
        """What speeds and accelerations count by."""
        self.ramp = self.present(
            self.max_speed,
            self.max_acceleration,
            self.a1,
            self.v1,
            self.max_deceleration,
            self.d1,
            self.vstart,
            self.vstop,
            self.min_speed,
        )
        """What decides the shape of a ramp."""
        self.always_fresh = (*self.counting, self.microsteps, self.actual_speed)
        """What the driver looks at each time that it looks in: how numbers count, and motions that another master
        began."""
        self.remembered = self.present(
            self.full_steps,
            self.external_resolution,
            *self.ramp,
            self.ramp_wait,
            self.step_direction,
            self.max_current,
            self.off_time,
            self.left_disabled,
            self.right_disabled,
        )
        """What the driver keeps in mind, and looks at again a few at a time: on a slow line each look costs others
        theirs."""
        self.moving = self.present(
            self.target_position,
            self.actual_position,
            self.target_speed,
            self.ramp_mode,
            self.microsteps,
            self.reverse_shaft,
            self.shaft_direction,
            self.step_direction,
        )
        """Parameters whose write may set the motor in motion or stop it. The position counter is among them: in
        positioning the module drives on to its target from wherever the counter says it is."""

        self.poll = (self.actual_position, self.actual_speed, self.position_reached)
        """What tells whether it still moves."""
        self.before = (self.actual_position, self.actual_speed, self.left_switch, self.right_switch)
        """What a motion begins from."""
        self.searching = (*self.poll, self.left_switch, self.right_switch, self.home_switch)
        """What tells how a reference search goes."""
        self.state = (
            self.actual_position,
            self.encoder,
            self.actual_position,
            self.external_encoder,
            self.actual_position,
            self.actual_speed,
            self.target_position,
            self.target_speed,
            self.position_reached,
            self.left_switch,
            self.right_switch,
            self.home_switch,
            self.driver_flags,
            self.step_direction,
        )
        """Each encoder between two readings of the position: their mean is the position of the same moment."""
        self.end = (
            self.actual_position,
            self.actual_speed,
            self.position_reached,
            self.left_switch,
            self.right_switch,
            self.left_disabled,
            self.right_disabled,
            self.driver_flags,
        )
        """What tells why a motion has ended."""

    def present(self, *rows: Register) -> tuple[Register, ...]:
        """Those of `rows` that this module has."""
        return tuple(row for row in rows if row not in self._absent)

    def coordinate(self, number: int) -> Register | None:
        """The row of a coordinate; None where there is none of that number."""
        return self.module.table.at(number, Space.COORDINATE)

    def _finder(self) -> Callable[[str], Register]:
        table = self.module.table

        def row(name: str) -> Register:
            """Raises KeyError for a name that no module has."""
            found = table.find(name, 0)
            if found is not None and found[1] is None:
                return found[0]
            missing = replace(_elsewhere(name), write_note=f"a {table.chip} has no {name}")
            self._absent.append(replace(missing, address=NOWHERE + missing.address))
            return self._absent[-1]

        return row


def _elsewhere(name: str) -> Register:
    found: Iterable[Register] = (row for module in MODULES.values() for row in module.table if row.name == name)
    for row in found:
        return row
    raise KeyError(name)


COUNTER_NAMES = ("actual_position", "microstep_resolution")
"""Parameters whose write makes the position counter show another number for the same place, or count other steps."""
