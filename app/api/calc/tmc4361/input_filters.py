"""Between the shapes of input filters and the calculator behind them, app/calc/signals/input_filter.py."""

from __future__ import annotations

from ....calc.signals.input_filter import EXAMPLES, Bounds, bounds, filtered, groups, levels_of
from ....registers.model import Field, Register
from ....registers.tmc4361.table import TMC4361
from ...devices.views import calculating
from .filter_schemas import FilterBounds, FilterExample, FilterGroup, InputFilter, InputFilterResult, InputFilters

REGISTER = "INPUT_FILT_CONF"


def input_filter(body: InputFilter) -> InputFilterResult:
    with calculating():
        found = filtered(body.input, body.sample_rate, body.length, body.initial, body.phase)
        return InputFilterResult(
            input=body.input,
            output=found.output.tolist(),
            sample_clocks=found.sample_clocks.tolist(),
            samples=found.samples.tolist(),
            bounds=_bounds(bounds(body.sample_rate, body.length, body.clock_hz)),
        )


def input_filters() -> InputFilters:
    register = TMC4361.get(REGISTER, 0)
    return InputFilters(
        register_name=register.name,
        groups=[
            FilterGroup(
                suffix=group.suffix,
                pins=list(group.pins),
                sample_rate_field=_field(register, f"sr_{group.suffix}").name,
                length_field=_field(register, f"filt_l_{group.suffix}").name,
                step_input_field=_field(register, f"sd_filt{number}").name,
            )
            for number, group in enumerate(groups(0))
        ],
        examples=[
            FilterExample(
                figure=example.figure,
                group=example.group,
                sample_rate=example.sample_rate,
                length=example.length,
                pin=example.pin,
                input=levels_of(example.edges, example.clocks).tolist(),
            )
            for example in EXAMPLES
        ],
    )


def _field(register: Register, name: str) -> Field:
    found = register.field_named(name)
    if found is None:
        raise KeyError(f"{register.name} has no field {name}")
    return found


def _bounds(limits: Bounds) -> FilterBounds:
    return FilterBounds(
        period_clocks=limits.period_clocks,
        delay_min_clocks=limits.delay_min_clocks,
        delay_max_clocks=limits.delay_max_clocks,
        stopped_clocks=limits.stopped_clocks,
        passed_clocks=limits.passed_clocks,
        period_s=limits.seconds(limits.period_clocks),
        delay_min_s=limits.seconds(limits.delay_min_clocks),
        delay_max_s=limits.seconds(limits.delay_max_clocks),
        stopped_s=limits.seconds(limits.stopped_clocks),
        passed_s=limits.seconds(limits.passed_clocks),
    )
