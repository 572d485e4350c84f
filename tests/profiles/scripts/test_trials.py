"""A script is offered when an emulator holds its profile after it, and only then."""

from __future__ import annotations

import shutil
from collections.abc import Callable

import pytest

from app.errors import WrongState
from app.profiles.capture import capture
from app.profiles.document import ProfileDocument, RegisterPart
from app.profiles.errors import UnreadableProfile
from app.profiles.scripts import proof, service
from app.profiles.scripts.emulated_device import emulated
from app.profiles.scripts.errors import ScriptFailed
from app.profiles.scripts.plan import Plan
from app.profiles.scripts.proof import Language
from app.profiles.scripts.service import RENDER, Scripts
from tests.profiles.scripts.documents import profile_of

IN_PROCESS: tuple[tuple[str, Language], ...] = (
    *((model, "c") for model in ("tmc428", "tmc4210", "tmc4361", "tmc5031", "tmc5072", "tmc5160", "pd42-1241")),
    ("pd42-1241", "tmcl"),
    ("tmcm-1161", "tmcl"),
    ("tmcm-1161", "c"),
)


@pytest.mark.parametrize(("model", "language"), IN_PROCESS)
async def test_what_was_captured_comes_back_by_its_script(model: str, language: Language) -> None:
    async with emulated(model, 16e6) as device:
        for part in profile_of(model).registers:
            await device.registers.write(part.name, part.axis, part.value, part.fields)
        document = await capture(device)
    script = await Scripts().make(document, language)
    assert script.checked.model == model
    assert script.checked.registers > 10
    assert script.checked.how in (("run",) if language == "tmcl" else ("compiled", "read"))


@pytest.mark.parametrize("language", ["python", "curl"])
async def test_programs_run_against_a_server_of_their_own(language: Language, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STEPSCOPE_URL", "http://127.0.0.1:9")  # the user's own is not for it
    scripts = Scripts()
    script = await scripts.make(profile_of("tmc5160", "quiet", "a 'note' with \"quotes\""), language)
    assert script.checked.how == "run"
    assert script.file_name == {"python": "quiet.py", "curl": "quiet.sh"}[language]
    assert await scripts.make(profile_of("tmc5160", "quiet", "a 'note' with \"quotes\""), language) is script


def without_one(render: Callable[[Plan], str], line: str) -> Callable[[Plan], str]:
    return lambda plan: "\n".join(each for each in render(plan).split("\n") if line not in each)


@pytest.mark.parametrize(("model", "language", "line"), [("tmc5160", "c", "VMAX"), ("pd42-1241", "tmcl", "SAP 6,")])
async def test_a_script_that_leaves_something_out_is_not_offered(
    model: str, language: Language, line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(RENDER, language, without_one(RENDER[language], line))
    with pytest.raises(ScriptFailed) as failed:
        await Scripts().make(profile_of(model), language)
    assert len(failed.value.differences) <= 1
    assert model in str(failed.value)


async def test_a_script_that_sets_a_motor_off_is_not_offered(monkeypatch: pytest.MonkeyPatch) -> None:
    # A TMC4361 is in velocity mode after a reset, where VMAX is the speed that it turns at.
    render = RENDER["c"]
    monkeypatch.setitem(RENDER, "c", lambda plan: render(plan).replace("{0x20u, 0x00000004u}", "{0x20u, 0x00000000u}"))
    with pytest.raises(ScriptFailed, match="moves"):
        await Scripts().make(profile_of("tmc4361"), "c")


async def test_a_header_that_does_not_compile_is_not_offered(monkeypatch: pytest.MonkeyPatch) -> None:
    if not any(map(shutil.which, proof.COMPILERS)):
        pytest.skip("no C compiler")
    render = RENDER["c"]
    monkeypatch.setitem(RENDER, "c", lambda plan: render(plan).replace("size_t part, i, sent", "size_t part, i, send"))
    with pytest.raises(ScriptFailed, match="ended with"):
        await Scripts().make(profile_of("tmc5160"), "c")


async def test_without_compiler_or_curl_our_own_reader_takes_the_writes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda program: None)
    for language in ("c", "curl"):
        script = await Scripts().make(profile_of("tmc428"), language)
        assert script.checked.how == "read"


async def test_a_program_that_hangs_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.profiles.scripts.process.RUN_WITHIN_S", 0.3)
    monkeypatch.setitem(RENDER, "curl", lambda plan: "#!/bin/sh\nsleep 600 & wait\n")
    with pytest.raises(ScriptFailed, match="not done after"):
        await Scripts().make(profile_of("tmc5160"), "curl")


async def test_chips_speak_no_tmcl_and_nothing_makes_no_script() -> None:
    with pytest.raises(WrongState, match="speaks no TMCL"):
        await Scripts().make(profile_of("tmc5160"), "tmcl")
    with pytest.raises(UnreadableProfile, match="nothing"):
        await Scripts().make(ProfileDocument(model="tmc5160", clock_hz=16e6), "c")
    wrong = profile_of("tmc428").model_copy(update={"registers": [RegisterPart(name="v_max", axis=0, value=5000)]})
    with pytest.raises(UnreadableProfile, match=r"0\.\.2047"):
        await Scripts().make(wrong, "c")


async def test_only_so_many_scripts_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(service, "KEPT", 2)
    scripts = Scripts()
    first = await scripts.make(profile_of("pd42-1241", "one"), "tmcl")
    for name in ("two", "three"):
        await scripts.make(profile_of("pd42-1241", name), "tmcl")
    again = await scripts.make(profile_of("pd42-1241", "one"), "tmcl")
    assert again is not first
    assert again.text == first.text
