"""Between the shapes of serial encoders and the calculator behind them, app/calc/tmc4361/serial_encoder.py."""

from __future__ import annotations

from dataclasses import asdict

from ....calc.tmc4361.serial_encoder import Frame, Requests, timing
from ...devices.views import calculating
from .serial_schemas import SerialEncoder, SerialEncoderResult


def serial_encoder(body: SerialEncoder) -> SerialEncoderResult:
    with calculating():
        frame = Frame(body.single_bits, body.multi_bits, body.status_bits, body.gray, body.status_last)
        requests = Requests(
            body.kind,
            body.clock_hz,
            body.high,
            body.low,
            body.delay,
            body.repeat_wait,
            body.period,
            body.twice,
            body.variation,
        )
        found = asdict(timing(frame, requests, body.counts_per_turn))
    return SerialEncoderResult.model_validate(
        {**found, "names": frame.names, "bits": frame.bits(body.turns, body.angle), "warnings": list(found["warnings"])}
    )
