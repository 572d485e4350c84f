"""What the page looks like in a browser, and pictures of its plots."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest
from PIL import Image
from playwright.sync_api import Page, expect


def test_density_and_clock_are_chosen_and_kept(page: Page) -> None:
    page.goto("/registers")
    html = page.locator("html")
    expect(html).to_have_attribute("data-density", "dense")
    page.get_by_role("button", name="Colours, density, times").click()
    page.get_by_role("menuitemradio", name="normal").click()
    expect(html).to_have_attribute("data-density", "normal")
    page.get_by_role("menuitemradio", name="UTC").click()
    page.reload()
    expect(html).to_have_attribute("data-density", "normal")
    row = page.locator("#main tr[data-row] td, #main tbody tr td").first
    expect(row).to_be_visible()
    page.get_by_role("button", name="Colours, density, times").click()
    expect(page.get_by_role("menuitemradio", name="UTC")).to_have_attribute("aria-checked", "true")


def test_a_plot_is_saved_as_a_picture(page: Page, tmp_path: Path) -> None:
    page.goto("/microsteps")
    save = page.get_by_role("button", name="Save a picture: Phase currents over a full period")
    save.hover()
    kept = {}
    for kind in ("PNG", "SVG"):
        save.click()
        with page.expect_download() as download:
            page.get_by_role("menuitem", name=kind).click()
        kept[kind] = tmp_path / download.value.suggested_filename
        download.value.save_as(kept[kind])
    assert kept["PNG"].name == "phase-currents-over-a-full-period.png"
    assert kept["PNG"].read_bytes().startswith(b"\x89PNG")
    svg = kept["SVG"].read_text()
    for text in ("Phase currents over a full period", "Phase B (cosine)", "\N{MINUS SIGN}63"):
        assert f">{text}</text>" in svg
    # both phases over 64 microsteps, now and (where they were read) before: one of each two is dashed
    lines = [line for line in svg.splitlines() if line.startswith("<path") and line.count("L") > 100]
    assert len(lines) in (2, 4)
    assert sum("stroke-dasharray" in line for line in lines) == len(lines) / 2


@pytest.mark.parametrize(
    ("path", "name", "texts"),
    [
        ("/microsteps", "Current vector over a period", {"A", "B"}),
        ("/ramps", "Pairs by quality", {"q", "settle", "recommended"}),
    ],
)
def test_a_drawing_is_saved_as_a_picture(page: Page, tmp_path: Path, path: str, name: str, texts: set[str]) -> None:
    page.goto(path)
    save = page.get_by_role("button", name=f"Save a picture: {name}")
    expect(save.locator("xpath=../..").locator("svg").first).to_be_visible()
    expect(page.locator("#main [aria-busy=true]")).to_have_count(0)
    kept = {}
    for kind in ("PNG", "SVG"):
        save.press("Enter")
        with page.expect_download() as download:
            page.get_by_role("menuitem", name=kind).press("Enter")
        kept[kind] = tmp_path / download.value.suggested_filename
        download.value.save_as(kept[kind])
    svg = ElementTree.fromstring(kept["SVG"].read_text())
    assert texts | {name} <= {"".join(each.itertext()) for each in svg.iter("{http://www.w3.org/2000/svg}text")}
    # no style, script or file of the page's is needed to see it
    looks = [value for each in svg.iter() for value in each.attrib.values()]
    assert not [value for value in looks if "var(" in value or "url(" in value or "//" in value]
    assert not {each.get("class") or each.get("href") for each in svg.iter()} - {None}
    picture = Image.open(kept["PNG"]).convert("RGB")
    assert picture.size == tuple(2 * int(svg.attrib[side]) for side in ("width", "height"))
    ground = picture.getpixel((0, 0))
    drawn = sum(count for count, colour in picture.getcolors(picture.width * picture.height) or () if colour != ground)
    assert drawn > 0.01 * picture.width * picture.height
