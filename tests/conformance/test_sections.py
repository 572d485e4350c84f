"""The list of sections and what refuses a wrong mark."""

from __future__ import annotations

import pytest

from tests.conformance.sections import documents, marks

pytest_plugins = ["pytester"]


def test_every_section_has_its_parent_listed_before_it() -> None:
    for document in documents().values():
        seen: set[str] = set()
        for number in document.sections:
            parent, _, _ = number.rpartition(".")
            assert not parent or parent in seen, (document.id, number)
            seen.add(number)


@pytest.fixture
def project(pytester: pytest.Pytester) -> pytest.Pytester:
    """A project of its own, with what the plugins of this one want to be told."""
    pytester.makeini(
        "[pytest]\nasyncio_default_fixture_loop_scope = function\nmarkers =\n  sheet(document, section): a statement"
    )
    return pytester


@pytest.mark.parametrize(
    "mark", ['"DS-TMC428", "8.99"', '"009", "1"', '"DS-TMC428", 8', '"DS-TMC428"', 'document="DS-TMC428", section="1"']
)
def test_a_mark_that_names_no_section_is_refused(project: pytest.Pytester, mark: str) -> None:
    item = project.getitem(f"import pytest\n\n@pytest.mark.sheet({mark})\ndef test_func(): ...")
    with pytest.raises(pytest.UsageError, match=r"sections\.toml|write @pytest"):
        list(marks(item))


def test_a_test_may_hold_several_sections(project: pytest.Pytester) -> None:
    item = project.getitem(
        "import pytest\n\n@pytest.mark.sheet('DS-TMC428', '8.1')\n"
        "@pytest.mark.sheet('DS-TMC4210', '6.1.1')\ndef test_func(): ..."
    )
    assert set(marks(item)) == {("DS-TMC428", "8.1"), ("DS-TMC4210", "6.1.1")}
