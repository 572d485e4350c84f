"""docs/not-modelled.md is as the tables have it."""

from __future__ import annotations

from not_modelled import PAGE, text


def test_the_page_lists_every_setting_that_is_not_modelled() -> None:
    assert PAGE.read_text(encoding="utf-8") == text().rstrip() + "\n", "run scripts/not_modelled.py"
