"""Steps and disturbances of a module are recorded by its built-in encoder, as those of chips are."""

from __future__ import annotations

from app.procedures.procedures import Procedures
from app.procedures.step_response import Window
from tests.devices.tmcl.harness import bench


async def test_a_step_of_a_module_is_recorded_and_scored() -> None:
    async with bench(load={"inertia_kgm2": 2e-5, "friction_nm": 0.02}) as b:
        procedures = Procedures(b.clock)
        procedures.start_step_response(b.device, 0, 5_120, window=Window(seconds=1.0, rate_hz=200.0))
        for _ in range(100):
            await b.clock.advance(0.05)
            found = procedures.step_response_state(b.device, 0)
            if found.state != "running":
                break
        assert found.state == "done", found.message
        assert found.recording is not None
        assert found.score is not None
        # A rotor follows within a full step, and rests within half of one: load angle and friction.
        assert 0 < found.score.peak < 256
        assert found.score.settling_s is not None
        await procedures.close()
