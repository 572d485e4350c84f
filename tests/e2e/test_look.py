"""What the page looks like in a browser, and pictures of its plots."""

from __future__ import annotations

from pathlib import Path

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
