"""What one write by hand costs on the wire, with its read-back and the prediction behind it: nothing is read twice."""

from __future__ import annotations

from collections import Counter

import pytest

from app.registers.catalog import CHIPS_32

from .harness import bench

FRAMES_AT_MOST = 12
"""Before, x_actual, v_actual, the write, the read-back, and what else decides a motion, once."""


@pytest.mark.parametrize("model", list(CHIPS_32))
@pytest.mark.parametrize("name", ["v_max", "v_min", "a_max", "pmul_pdiv", "x_target"])
async def test_a_write_at_rest_reads_nothing_twice_and_takes_one_turn(model: str, name: str) -> None:
    async with bench(model) as b:
        register = b.device.family.table.get(name, 0)
        held = (await b.device.registers.read(name, 0)).raw
        log = b.device.session.queue.log
        before = log.next
        await b.device.registers.write(name, 0, register.decode(held))
        frames = [frame.tx for frame in log.page(before).frames]
        reads = Counter(frame[0] >> 1 for frame in frames if frame[0] & 1)
        # What it held before, and what it holds now.
        assert reads.pop(register.address) == 2
        assert set(reads.values()) == {1}, reads
        assert len(frames) <= FRAMES_AT_MOST
