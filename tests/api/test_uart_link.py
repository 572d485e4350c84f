"""TMC5xxx over the single wire of a UART, as a script sees them: two chips on one wire with an echo."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from app.clock import WallClock
from app.emulators.line.pty import PtyEnd
from app.emulators.line.server import LineServer
from app.emulators.line.uart import uart_line
from app.emulators.tmc5xxx import EmulatedTmc5xxx
from app.links import discovery
from tests.api.test_links import probed

NODECONF = 0x03


@pytest.fixture(autouse=True)
def _patience(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(discovery, "WAIT_S", 0.5)  # for chips that are a thread on a busy machine


@pytest.fixture
def wire(tmp_path: Path) -> Iterator[str]:
    """A TMC5160 at node 1 and a TMC5130 at node 2, on the wall clock: their port."""
    clock, port = WallClock(), tmp_path / "tty"
    chips = [EmulatedTmc5xxx("tmc5160", clock), EmulatedTmc5xxx("tmc5130", clock)]
    for node, chip in enumerate(chips, 1):
        chip.write(NODECONF, node)
    with LineServer(uart_line(chips, clock, nodes=(1, 2), echo=True), [PtyEnd(port)]) as server:
        serving = threading.Thread(target=server.run)
        serving.start()
        yield str(port)
        server.stop()
        serving.join()


async def test_two_chips_share_a_wire(wire: str, client: httpx.AsyncClient) -> None:
    made = []
    for node, model in ((1, "tmc5160"), (2, "tmc5130")):
        body = {"name": model, "model": model, "link": {"kind": "uart", "port": wire, "node": node, "timeout_s": 20.0}}
        answer = await client.post("devices", json=body)
        assert answer.status_code == 201, answer.text
        made.append(answer.json())
        assert made[-1]["state"] == "connected", answer.text
        written = await client.put(f"devices/{model}/registers/XACTUAL?axis=0", json={"value": -1000 * node})
        assert (written.json()["value"], written.json()["verified"]) == (-1000 * node, True)
    assert made[0]["link"] == {"kind": "uart", "port": wire, "node": 1, "timeout_s": 20.0}
    values = [(await client.get(f"devices/{model}/registers/XACTUAL?axis=0")).json()["value"] for model in
              ("tmc5160", "tmc5130")]  # fmt: skip
    assert values == [-1000, -2000]
    link = (await client.get("devices/tmc5160/link")).json()
    assert (link["kind"], link["shared_with"]) == ("uart", ["tmc5130"])
    assert set(link["counts"]["incidents"]) == {"opened"}


async def test_a_register_that_cannot_be_read_is_known_to_have_arrived(wire: str, client: httpx.AsyncClient) -> None:
    body = {"name": "chip", "model": "tmc5160", "link": {"kind": "uart", "port": wire, "node": 1, "timeout_s": 20.0}}
    await client.post("devices", json=body)
    written = (await client.put("devices/chip/registers/AMAX?axis=0", json={"value": 1000})).json()
    assert written["verified"] is True
    assert "arrived" in written["note"]


async def test_the_log_tells_datagrams(wire: str, client: httpx.AsyncClient) -> None:
    body = {"name": "chip", "model": "tmc5160", "link": {"kind": "uart", "port": wire, "node": 1, "timeout_s": 20.0}}
    await client.post("devices", json=body)
    await client.put("devices/chip/registers/VMAX?axis=0", json={"value": 200_000})
    await client.get("devices/chip/registers/XACTUAL?axis=0")
    log = (await client.get("devices/chip/frames")).json()["frames"]
    texts = [entry["text"] for entry in log]
    assert any(text.startswith("VMAX := 200000 (write ") for text in texts), texts
    assert texts[-1] == "read XACTUAL -> 0"
    assert log[-1]["tx"] == "050121" + log[-1]["tx"][-2:]


@pytest.mark.parametrize(
    ("model", "link", "part"),
    [
        ("tmc5031", {}, "a tmc5031 has no uart link"),
        ("tmc5062", {"node": 1}, "node"),
        ("tmc4361", {}, "uart"),
        ("tmc5160", {"node": 255}, "node"),
        ("tmc5160", {"echo": "maybe"}, "echo"),
        ("tmc5160", {"baud": 4800}, "baud"),
    ],
)
async def test_links_that_cannot_be(client: httpx.AsyncClient, model: str, link: dict[str, object], part: str) -> None:
    body = {"name": "chip", "model": model, "link": {"kind": "uart", "port": "/dev/nowhere", **link}}
    answer = await client.post("devices", json=body)
    assert answer.status_code == 422
    assert part in answer.json()["detail"]


async def test_a_link_is_tried(wire: str, client: httpx.AsyncClient) -> None:
    for node, ok in ((1, True), (9, False)):
        link = {"kind": "uart", "port": wire, "node": node, "timeout_s": 20.0 if ok else 0.05}
        trial = (await client.post("devices/test", json={"model": "tmc5160", "link": link})).json()
        assert trial["ok"] is ok, trial
    assert "node 9" in trial["problem"]["detail"]
    assert "only its echo came" in trial["problem"]["detail"]


async def test_chips_are_found_on_a_port(wire: str, client: httpx.AsyncClient) -> None:
    body = {"port": wire, "kind": "chips", "bauds": [115_200], "addresses": [0, 1, 2]}
    assert (await client.post("ports/probe", json=body)).status_code == 202
    state = await probed(client)
    found = [(chip["kind"], chip["address"], chip["model"], chip["version"]) for chip in state["found"]]
    assert found == [("chip", 1, "tmc5160", "version 0x30"), ("chip", 2, "tmc5130", "version 0x11")]
    for kind, address in (("chips", 255), ("modules", 0)):
        refused = await client.post("ports/probe", json={"port": wire, "kind": kind, "addresses": [address]})
        assert refused.status_code == 422
