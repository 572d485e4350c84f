"""A recording as one HTML file: what is drawn is what was measured, gaps stay gaps, and nothing is fetched."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import httpx
import pytest

from app.clock import VirtualClock
from tests.api.test_recordings import run, start, with_gap

LINE = re.compile(r'<polyline points="([^"]+)"[^>]*><title>([^<]+)</title>')
TICK = re.compile(r'<text x="([\d.]+)" y="([\d.]+)" text-anchor="end">([^<]+)</text>')


async def report(client: httpx.AsyncClient, recording: str, **stretch: float) -> str:
    answer = await client.get(f"recordings/{recording}/report", params=stretch)
    assert answer.headers["content-type"].startswith("text/html")
    assert f'filename="recording-{recording}.html"' in answer.headers["content-disposition"]
    return answer.text


def lines(page: str) -> list[tuple[str, list[tuple[float, float]]]]:
    """Each line of the plots: its channel, and its points [pixels]."""
    found = []
    for points, channel in LINE.findall(page):
        pairs = [point.split(",") for point in points.split()]
        found.append((channel, [(float(x), float(y)) for x, y in pairs]))
    return found


async def curves(client: httpx.AsyncClient, recording: str) -> Mapping[str, Any]:
    plot = (await client.get(f"recordings/{recording}/plot", params={"points": 1500})).json()
    return {curve["channel"]: curve for curve in plot["curves"]}


async def test_it_draws_what_was_measured(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client, name="slide <b>&co", note="warm")
    await client.post("devices/bench/axes/0/move", json={"target": 2000})
    await run(clock, 2.0)
    await client.post(f"recordings/{recording}/marks", json={"text": "here it sang"})
    await client.post(f"recordings/{recording}/stop")
    page = await report(client, recording)
    assert "<h1>slide &lt;b&gt;&amp;co</h1>" in page
    assert "here it sang" in page
    assert not re.search(r"<script|https?://|<link|<img", page), "it needs nothing else"

    drawn, measured = dict(lines(page)), await curves(client, recording)
    assert drawn.keys() == {"position.0", "velocity.0"}
    for channel, points in drawn.items():
        values, times_s = measured[channel]["values"], measured[channel]["time_s"]
        assert len(points) == len(values)
        # pixels and values are one straight line: the scale that the plot draws
        heights, widths = [y for _, y in points], [x for x, _ in points]
        for pixels, true in ((heights, values), (widths, times_s)):
            slope = (pixels[-1] - pixels[0]) / (true[-1] - true[0]) if true[-1] != true[0] else None
            least, most = true.index(min(true)), true.index(max(true))
            slope = slope or (pixels[most] - pixels[least]) / (true[most] - true[least])
            for pixel, value in zip(pixels, true, strict=True):
                assert pixel == pytest.approx(pixels[0] + slope * (value - true[0]), abs=0.11), channel
    # and the ticks of the first plot lie on that line too
    (x0, _), *_ = drawn["position.0"]
    heights, values = [y for _, y in drawn["position.0"]], measured["position.0"]["values"]
    slope = (heights[-1] - heights[0]) / (values[-1] - values[0])
    ticks = [(float(y) - 4, float(text)) for x, y, text in TICK.findall(page.split("</svg>")[0]) if float(x) < x0]
    assert len(ticks) == 5
    for height, value in ticks:
        assert height == pytest.approx(heights[0] + slope * (value - values[0]), abs=1.0)


async def test_of_a_stretch_it_tells_that_stretch(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client)
    await run(clock, 0.5)
    await client.post(f"recordings/{recording}/marks", json={"text": "early"})
    await run(clock, 1.0)
    await client.post(f"recordings/{recording}/marks", json={"text": "late"})
    await client.post(f"recordings/{recording}/stop")
    page = await report(client, recording, from_s=1.0, to_s=1.5)
    assert "late" in page
    assert "early" not in page
    figures = (await client.get(f"recordings/{recording}/figures", params={"from_s": 1.0, "to_s": 1.5})).json()
    samples = figures["figures"]["position.0"]["samples"]
    assert f"{samples} samples" in page
    assert re.search(rf"<td>position.0</td>.*?<td>{samples}</td>", page)


async def test_a_gap_stays_a_gap(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await with_gap(client, clock)
    page = await report(client, recording)
    parts = [points for channel, points in lines(page) if channel == "position.0"]
    assert len(parts) == 2, "one line before the gap, one after it"
    assert parts[1][0][0] - parts[0][-1][0] > 100, "half of the time is missing"


async def test_where_nothing_was_sampled_it_says_so(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client)
    await run(clock, 0.5)
    await client.post(f"recordings/{recording}/stop")
    page = await report(client, recording, from_s=50.0, to_s=60.0)
    assert "No samples in this stretch." in page
    assert "<svg" not in page
