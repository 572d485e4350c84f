"""What holds for every test."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest
from hypothesis import settings

from app.kernels import all_compiled
from app.preparation import compile_kernels
from tests.conformance import sections

# How fast something is, `make bench` measures; here a busy machine must not fail a test that is right.
settings.register_profile("stepscope", deadline=None)
settings.load_profile("stepscope")


HERE = Path(__file__).parent
SLOW = (
    "api",  # a server each
    "client",
    "docker",
    "peers",
    "twin",
    "conditions/test_encoder_trace.py",  # a second a test, and more
    "conditions/test_watching.py",
    "conformance/test_sections.py",
    "calc/test_microstep_metrics.py",
    "calc/test_ramp.py",
    "calc/test_sixpoint_against_drive.py",
    "calc/test_sramp_many.py",
    "devices/limits/test_every_path.py",
    "devices/limits/test_watch.py",
    "devices/test_register_writes.py",
    "devices/tmc4361/test_over_links.py",
    "devices/tmcl/test_missing_parameters.py",
    "emulators/test_oracle.py",
    "emulators/test_process_end.py",
    "emulators/tmcl/test_search.py",
    "links/test_emulated_process.py",
    "links/test_landungsbruecke.py",
    "links/test_staying_in_step.py",
    "procedures/test_reference_search.py",
    "profiles/scripts/test_trials.py",
    "studies/test_custom_search.py",
    "studies/test_fastest_move.py",
    "studies/test_stallguard.py",
    "studies/test_twin.py",
    "studies/test_s_ramps.py",
    "store/test_damaged_directory.py",
    "store/test_hand_edited.py",
    "store/test_noise_in_database.py",
    "store/test_private.py",
    "telemetry/test_feed.py",
    "test_house.py",
    "test_wheel.py",
)
"""What `make test-fast` leaves to `make test`."""
DRIVES = ("conditions", "devices", "emulators", "positions", "procedures", "profiles", "studies")
"""Where tests drive emulated chips in their own process."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Refuse `sheet` marks that name no section of a data sheet, and mark what is slow."""
    sections.check(items)
    for item in items:
        place = item.path.relative_to(HERE).as_posix() if _is_here(item) else ""
        if place.startswith(SLOW):
            item.add_marker(pytest.mark.slow)


def _is_here(item: pytest.Item) -> bool:
    return item.path.is_relative_to(HERE)


def pytest_collection_finish(session: pytest.Session) -> None:
    """Compile what tests need: else servers would do it behind their answers, as on a user's first start, and a test
    within its own time, which ends before where the machine has other work too."""
    need = any(item.get_closest_marker(name) for item in session.items for name in ("slow", "e2e"))
    need = need or any(item.path.relative_to(HERE).parts[0] in DRIVES for item in session.items if _is_here(item))
    if need and not session.config.option.collectonly and not all_compiled():
        compile_kernels()
    # As the server does: to look through all modules and tests takes half a second, whenever a device was removed.
    gc.freeze()
