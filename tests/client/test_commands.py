"""The commands that ask a running server, through the program's own parser."""

from __future__ import annotations

import asyncio
import csv
import json
import os
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from app.cli import cli
from app.commands import COMMANDS


async def run(server: str, *arguments: str) -> Result:
    """`stepscope ARGUMENTS`, asked of `server`, in a thread: the server's loop has to go on."""
    return await asyncio.to_thread(CliRunner(env={"STEPSCOPE_URL": server}).invoke, cli, list(arguments))


def said(result: Result) -> str:
    assert result.exit_code == 0, result.output
    return result.stdout


async def test_a_session(server: str, tmp_path: Path) -> None:
    assert "TMC428" in said(await run(server, "devices"))
    assert [each["id"] for each in json.loads(said(await run(server, "devices", "--json")))] == ["bench", "slider"]
    assert "verified" in said(await run(server, "write", "bench", "V_MAX=0x4B0", "A_MAX=300", "--axis", "0"))
    readings = json.loads(said(await run(server, "read", "bench", "V_MAX", "A_MAX", "--axis", "0", "--json")))
    assert [reading["value"] for reading in readings] == [1200, 300]
    assert "at 3200" in said(await run(server, "move", "bench", "3200"))
    assert "at 1200" in said(await run(server, "move", "bench", "--relative", "--", "-2000"))
    state = json.loads(said(await run(server, "axis", "bench", "--json")))
    assert (state["position"], state["position_reached"]) == (1200, True)
    assert "1200 microsteps" in said(await run(server, "axis", "bench"))

    file = tmp_path / "run.csv"
    said(await run(server, "watch", "bench", "position.0", "velocity.0", "--seconds", "0.05", "--out", str(file)))
    rows = list(csv.reader(file.read_text().splitlines()))
    assert rows[0] == ["time_s", "position.0 [microsteps]", "velocity.0 [pps]"]
    assert {row[1] for row in rows[1:]} == {"1200"}


async def test_turning_and_stopping(server: str) -> None:
    assert "turns at" in said(await run(server, "rotate", "bench", "1000", "--axis", "1"))
    assert json.loads(said(await run(server, "axis", "bench", "--axis", "1", "--json")))["moving"]
    assert "3 axes" in said(await run(server, "stop", "bench"))
    assert "1 axis" in said(await run(server, "stop", "bench", "--axis", "1", "--immediate"))
    assert "4 axes" in said(await run(server, "stop"))
    assert not json.loads(said(await run(server, "axis", "bench", "--axis", "1", "--json")))["moving"]


async def test_a_start_up_is_shown_and_then_done(server: str) -> None:
    said(await run(server, "write", "slider", "V_MAX=0", "--axis", "0"))
    refused = await run(server, "move", "slider", "100")
    assert (refused.exit_code, "start it up" in refused.output) == (1, True)
    shown = said(await run(server, "start-up", "slider", "velocity_pps=8000", "--dry-run"))
    assert "would be written" in shown
    assert "V_MAX" in shown
    assert json.loads(said(await run(server, "read", "slider", "V_MAX", "--axis", "0", "--json")))[0]["value"] == 0
    assert "written" in said(await run(server, "start-up", "slider", "velocity_pps=8000", "--axis", "0"))
    assert "at 100" in said(await run(server, "move", "slider", "100"))
    assert "unchanged" in said(await run(server, "start-up", "slider", "velocity_pps=8000"))
    assert (await run(server, "start-up", "slider", "microsteps=3")).exit_code == 1


async def test_calculators_and_any_other_call(server: str) -> None:
    answer = said(await run(server, "calc", "pmul-pdiv", "chip=tmc428", "a_max=500", "ramp_div=7", "pulse_div=5"))
    assert json.loads(answer)["pmul"] == 109
    changed = await run(server, "api", "PATCH", "devices/bench/emulator", "faults.silence=true")
    assert json.loads(said(changed))["faults"]["silence"] is True
    assert json.loads(said(await run(server, "api", "GET", "/api/v1/health")))["status"] == "ok"


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("read", "bench", "NOPE"), 1, "NOPE"),
        (("move", "bench", "1e30"), 1, "8388607"),
        (("axis", "nobody"), 1, "known: bench"),
        (("write", "bench", "V_MAX"), 2, "NAME=VALUE"),
        (("write", "bench", "V_MAX=fast"), 2, "FIELD"),
        (("devices", "--url", "http://127.0.0.1:1"), 3, "stepscope serve"),
        (("devices", "--url", "nowhere"), 2, "http://HOST:PORT"),
        (("stop", "slider", "--axis", "7"), 1, "axis"),
    ],
)
async def test_what_goes_wrong_is_a_line_and_a_code(
    server: str, arguments: tuple[str, ...], code: int, words: str
) -> None:
    result = await run(server, *arguments)
    assert result.exit_code == code, result.output
    assert words in result.output
    assert result.output.strip().startswith("stepscope: ")
    assert isinstance(result.exception, SystemExit), "told, not thrown"


async def test_a_bad_assignment_writes_nothing(server: str) -> None:
    before = json.loads(said(await run(server, "read", "bench", "V_MAX", "--axis", "0", "--json")))[0]["value"]
    assert (await run(server, "write", "bench", "V_MAX=77", "A_MAX", "--axis", "0")).exit_code == 2
    after = json.loads(said(await run(server, "read", "bench", "V_MAX", "--axis", "0", "--json")))[0]["value"]
    assert after == before


async def test_a_switch_in_the_way_is_told(server: str) -> None:
    said(await run(server, "api", "PATCH", "devices/bench/emulator", 'switches=[{"axis": 0, "right": true}]'))
    result = await run(server, "move", "bench", "20000")
    assert result.exit_code == 5, result.output
    assert "right" in result.output


async def test_homing_where_no_stall_is_measured_is_refused(server: str) -> None:
    result = await run(server, "home", "bench", "right", "--hits", "2")
    assert result.exit_code == 1
    assert "measures no stall" in result.output


def test_every_command_explains_itself() -> None:
    for command in COMMANDS:
        result = CliRunner().invoke(cli, [command.__name__.replace("_", "-"), "--help"])
        assert result.exit_code == 0
        assert "Usage" in result.output


async def test_recording_and_what_was_recorded(server: str, tmp_path: Path) -> None:
    file = tmp_path / "run.parquet"
    done = await run(
        server, "record", "bench", "position.0", "--seconds", "0.3", "--name", "still", "--out", str(file), "--json"
    )
    recorded = json.loads(said(done))
    assert (recorded["state"], recorded["name"]) == ("done", "still")
    assert file.stat().st_size > 0
    assert recorded["id"] in said(await run(server, "recordings", "still"))
    assert recorded["id"] not in said(await run(server, "recordings", "moving"))
    again = json.loads(said(await run(server, "replay", recorded["id"], "--json")))
    assert (again["state"], again["of"]) == ("done", recorded["id"])
    difference = said(await run(server, "compare", recorded["id"], again["recording"]))
    assert "position.0" in difference
    alone = await run(server, "compare", recorded["id"])
    assert (alone.exit_code, "two recordings" in alone.output) == (1, True)
    refused = await run(server, "record", "bench", "position.0", "--seconds", "1", "--out", str(tmp_path / "x.txt"))
    assert (refused.exit_code, ".parquet" in refused.output) == (2, True)


async def test_a_reader_that_has_seen_enough_ends_it_quietly(server: str) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        "-m",
        "app.cli",
        "read",
        "bench",
        "--json",
        env={**os.environ, "STEPSCOPE_URL": server},
        stdout=writing,
        stderr=asyncio.subprocess.PIPE,
    )
    os.close(writing)
    _, said = await process.communicate()
    assert (process.returncode, said) == (0, b"")


async def test_the_audit_log(server: str) -> None:
    said(await run(server, "write", "bench", "V_MAX=1300", "--axis", "0"))
    said(await run(server, "write", "bench", "V_MAX=1301", "--axis", "0"))
    refused = await run(server, "write", "bench", "V_MAX=99999", "--axis", "0")
    assert refused.exit_code == 1
    entries = json.loads(said(await run(server, "audit", "--q", "v_max", "--limit", "2", "--json")))
    assert [(entry["old"], entry["new"], entry["outcome"].partition(":")[0]) for entry in entries] == [
        (None, 99999, "refused"),
        (1300, 1301, "done"),
    ]
    shown = said(await run(server, "audit", "--action", "write", "--device", "bench", "--since", "5min"))
    assert "v_max 1300 -> 1301" in shown
    rows = list(csv.DictReader(said(await run(server, "audit", "--q", "1301", "--csv")).splitlines()))
    assert [(row["subject"], row["new"]) for row in rows] == [("v_max", "1301")]
    assert json.loads(said(await run(server, "audit", "--who", "nobody", "--json"))) == []
    wrong = await run(server, "audit", "--since", "yesterday")
    assert wrong.exit_code == 2
    assert "how long ago" in wrong.output


async def test_register_maps(server: str, tmp_path: Path) -> None:
    file, table = tmp_path / "Ramp_Core.toml", tmp_path / "table.csv"
    file.write_text('format = 1\ntitle = "Ramp core"\n[[register]]\nname = "MODE"\naddress = 300\n')
    checked = await run(server, "maps", "check", str(file))
    assert (checked.exit_code, f"{file}:5: register MODE, address" in checked.output) == (1, True)
    refused = await run(server, "maps", "add", str(file))
    assert (refused.exit_code, f"{file}:5: register MODE, address" in refused.output) == (1, True)
    file.write_text(file.read_text().replace("300", "3"))
    assert "1 registers, nothing wrong" in said(await run(server, "maps", "check", str(file)))
    assert "ramp-core: Ramp core" in said(await run(server, "maps", "add", str(file)))
    table.write_text("register,address\nA,1\n")
    said(await run(server, "maps", "add", str(table), "--name", "other"))
    assert [line.split()[0] for line in said(await run(server, "maps", "list")).splitlines()] == [
        "name",
        "other",
        "ramp-core",
    ]
    assert said(await run(server, "maps", "get", "ramp-core")) == file.read_text()
    said(await run(server, "maps", "delete", "other"))
    assert (await run(server, "maps", "get", "other")).exit_code == 1
