"""Kernels as plain Python, which serve until they are compiled: equal to the machine code in every bit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from app import kernels
from app.calc.ramps.sramp import SRamp, position_plan, velocity_plan
from app.calc.ramps.ticked import RampParameters, exact_ramp
from app.emulators.tmc428.options import EmulatorOptions, StageOptions
from app.emulators.tmc428.tmc428 import Tmc428
from tests.emulators.lockstep import Chaos, Trips


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """As in a server that has compiled nothing yet; what would compile fails."""
    for kernel in kernels._kernels:
        monkeypatch.setattr(kernel, "_ready", None)
    kernels.plain_meanwhile(on=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kernels.Kernel, "dispatcher", property(lambda kernel: pytest.fail(f"{kernel.__name__} compiles")))
        yield
    kernels.plain_meanwhile(on=False)


@pytest.mark.parametrize(("kind", "step_dir", "seed"), [(Chaos, False, 100), (Trips, False, 201), (Chaos, True, 500)])
@pytest.mark.usefixtures("plain")
def test_an_emulated_chip_is_what_its_oracle_is(kind: type[Chaos], step_dir: bool, seed: int) -> None:
    run = kind(seed, (0, 3), step_dir)
    run.play(20_000, 40)
    assert run.pair.clock // 32 > 10_000


def moved() -> list[list[int]]:
    """Three axes on their way, by cells."""
    chip = Tmc428(EmulatorOptions(stages=[StageOptions()] * 3))
    for axis in range(3):
        for register, word in ((2, 1), (3, 1500), (6, 400 + axis), (9, 128 << 8 | 7), (12, 3 << 12 | 7 << 8 | 4)):
            chip.exchange((axis << 4 | register) << 25 | word, 0)
        chip.exchange(axis << 29 | 900 * (axis + 1), 0)
    chip.record(np.arange(1, 40, dtype=np.int64) * 100_000)
    return [*chip.axes.tolist(), chip.chip.tolist()]


def ramps() -> list[object]:
    """Predictions of both calculators, with all of their samples."""
    chip = RampParameters(v_min=1, v_max=1500, a_max=300, ramp_div=7, pulse_div=3, pmul=180 - 128, pdiv=7)
    s_ramp = SRamp(100_000.0, 4e5, 3e5, 4e6, 5e6, 6e6, 7e6)
    curve = exact_ramp(chip, 5000, samples=100)
    return [
        curve.position.tolist(),
        curve.velocity_256.tolist() if curve.velocity_256 is not None else None,
        position_plan(s_ramp, 51_200.0, 300.0, -20.0),
        velocity_plan(s_ramp, -40_000.0, 30_000.0),
    ]


@pytest.fixture
def compiled() -> tuple[object, object]:
    """What machine code says."""
    return moved(), ramps()


def test_machine_code_says_the_same(compiled: tuple[object, object], request: pytest.FixtureRequest) -> None:
    request.getfixturevalue("plain")
    assert (moved(), ramps()) == compiled


@kernels.Kernels(__file__, plain=True).compiled
def divided(x: int) -> int:
    return 1 // x


@kernels.Kernels(__file__, plain=True, views=True).compiled
def counted(cells: NDArray[np.int64], of: NDArray[np.int64]) -> int:
    cells[0] += 1
    return 1 // int(of[0])


@pytest.mark.usefixtures("plain")
def test_what_is_left_to_machine_code_begins_from_what_was_there() -> None:
    """Not from where plain Python came to, on arrays of which one is a part of the other."""
    cells = np.array([1, 0], dtype=np.int64)
    assert counted(cells, cells) == 0
    with pytest.raises(pytest.fail.Exception, match="counted compiles"):
        counted(cells, cells[1:])
    assert cells.tolist() == [2, 0]


@pytest.mark.usefixtures("plain")
def test_what_only_machine_code_can_is_left_to_it() -> None:
    """A division by zero, which is no error there."""
    assert divided(1) == 1
    with pytest.raises(pytest.fail.Exception, match="divided compiles"):
        divided(0)
