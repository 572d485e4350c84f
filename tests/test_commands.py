"""Commands that README and the documents tell to type: each runs, in the order of its page, beside the demo bench.

Tutorials and how-to pages have tests of their own. What cannot run here is named, with why.
"""

from __future__ import annotations

import os
import re
import select
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import httpx
import pytest
from server_process import ServerProcess, free_port

from app.registers import catalog
from tests.installation import until

ROOT = Path(__file__).parent.parent
PAGES = ("README", *(f"docs/{name}" for name in ("access", "extended-positions", "links", "listed-models")))
PAGES += ("docs/profiles", "docs/register-maps", "docs/tcp-link", "docs/how/macros")
OWN_TESTS = {"docs/how/back-up", "docs/how/on-a-network", "docs/how/ramp-law"}
NOT_HERE = {
    "--dask": "needs a cluster: tests/studies has one on loopback",
    "--can": "needs a CAN interface of the kernel",
    "pip install": "tests/test_wheel.py and tests/docker install it",
}
COMMAND = re.compile(r"^(?: {4})?(?:\.venv/bin/)?((?:stepscope|curl|[A-Z]=) ?.*)$")
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```|((?:^ {4}\S.*\n(?: {5,}\S.*\n)*)+)", re.DOTALL | re.MULTILINE)
SERVES = re.compile(r"^stepscope (?:serve|emulate|tune start) ")
"""What goes on, until Ctrl-C or for minutes: it has to say something, and to be there then."""
LASTS_S = 100.0
FAR = {"left_at_fullsteps": -1e6, "right_at_fullsteps": 1e6}
LISTED = next(model.name for model in catalog.listings() if model.kind == "chip")
PROGRAM = """\
MVP ABS, 0, 4000
WAIT POS, 0, 0
Done: STOP
"""


def commands(text: str) -> Iterator[str]:
    """Each with what it goes on with, comments left out where the shell would."""
    for language, fenced, indented in BLOCK.findall(text):
        if language not in ("", "sh"):
            continue
        lines = (fenced or indented).replace("\\\n", " ").splitlines()
        yield from (found[1].strip() for line in lines if (found := COMMAND.match(line)))


def why_not(command: str) -> str:
    return next((why for part, why in NOT_HERE.items() if part in command), "")


class Reader:
    """Who types them, in a folder of his own."""

    def __init__(self, folder: Path, api: httpx.Client, stack: ExitStack) -> None:
        self.folder, self.api, self.stack = folder, api, stack
        url = str(api.base_url.copy_with(path="")).rstrip("/")
        self.ports = {"8000": url.rsplit(":", 1)[1]}
        self.variables = ""
        self.environment = {name: value for name, value in os.environ.items() if not name.startswith("STEPSCOPE_")} | {
            "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
            "HOME": str(folder),
            "STEPSCOPE_URL": url,
            "STEPSCOPE_DATA_DIR": str(folder / "data"),
        }

    def here(self, command: str) -> str:
        """With free ports, a model and a device that are there, and files where nobody else's are."""

        def port(found: re.Match[str]) -> str:
            return found[1] + self.ports.setdefault(found[2], str(free_port()))

        command = re.sub(r"(127\.0\.0\.1:)(\d+)", port, command)
        command = command.replace("--port 8000", f"--port {free_port()}").replace("/tmp/", f"{self.folder}/")
        return command.replace("DEVICE", "drum" if "extended-position" in command else "bench").replace("MODEL", LISTED)

    def types(self, command: str) -> str:
        """Why it went wrong, or nothing. What serves goes on until the page is at its end."""
        if re.match(r"[A-Z]=", command):
            self.variables += self.here(command) + "\n"
            return ""
        line = self.variables + self.here(command)
        if SERVES.match(command):
            return self.serves(line)
        process = subprocess.Popen(
            [
                "bash",
                "-e",
                "-u",
                "-o",
                "pipefail",
                "-c",
                re.sub(r"^curl |(?<=\n)curl ", "curl --fail-with-body -sS ", line),
            ],
            cwd=self.folder,
            env=self.environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.stack.callback(process.kill)
        if "--on-move" in command:
            until(self.waits)
            self.moves()
        if " macro record " in command:
            assert process.stdout is not None
            process.stdout.read(1)  # it asks for Enter
            self.moves()
        said, _ = process.communicate("\n", timeout=LASTS_S)
        if "/stop " in command:
            until(lambda: not self.api.get("devices/drum/axes/0").raise_for_status().json()["moving"])
        return "" if process.returncode == 0 else f"{command}: {process.returncode}\n{said}"

    def waits(self) -> bool:
        found = self.api.get("recordings").raise_for_status().json()["recordings"]
        return any(each["state"] == "waiting" for each in found)

    def moves(self) -> None:
        self.api.post("devices/bench/axes/0/move", json={"target": 500}).raise_for_status()

    def serves(self, line: str) -> str:
        process = self.stack.enter_context(
            subprocess.Popen(
                ["bash", "-c", f"exec {line}"],
                cwd=self.folder,
                env=self.environment,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
            )
        )
        self.stack.callback(process.terminate)
        assert process.stdout is not None
        ready, _, _ = select.select([process.stdout], [], [], LASTS_S)
        said = process.stdout.readline().decode() if ready else ""
        return "" if said and process.poll() is None else f"{line}: {said or 'says nothing'}"


@pytest.fixture
def reader(tmp_path: Path) -> Iterator[Reader]:
    (tmp_path / "homing.tmc").write_text(PROGRAM)
    example = re.search(r"^```toml\n(.*?)^```", (ROOT / "docs/register-maps.md").read_text(), re.DOTALL | re.MULTILINE)
    assert example is not None
    (tmp_path / "ramp-core.toml").write_text(example[1])
    with (
        ServerProcess(tmp_path / "data") as server,
        httpx.Client(base_url=f"{server.url}/api/v1/", timeout=60) as api,
        ExitStack() as stack,
    ):
        # No switch is within reach; the one has a hard end nearby, the other one turns without any.
        for name, model, stage in (("motor", "pd42-1241", FAR | {"left_end_fullsteps": -50}), ("drum", "tmc4361", FAR)):
            link = {"kind": "emulator", "stage": stage}
            body = {"name": name, "model": model, "link": link, "start_up": True}
            api.post("devices", json=body).raise_for_status()
        yield Reader(tmp_path, api, stack)


@pytest.mark.slow
@pytest.mark.timeout(400)
@pytest.mark.parametrize("page", PAGES)
def test_its_commands_run(reader: Reader, page: str) -> None:
    told = [command for command in commands((ROOT / f"{page}.md").read_text()) if not why_not(command)]
    assert told, "a page without any need not be here"
    wrong = [found for command in told if (found := reader.types(command))]
    assert not wrong, "\n".join(wrong)


def test_no_page_with_commands_is_left_out() -> None:
    pages = [path for path in (ROOT / "docs").rglob("*.md") if "tutorials" not in path.parts]
    having = {
        str(path.relative_to(ROOT).with_suffix(""))
        for path in pages
        if any(not why_not(each) for each in commands(path.read_text()))
    }
    assert having - {*PAGES, *OWN_TESTS} == set()
