"""The list of components is the lock file's, each with a licence that may be shipped and a use."""

from pathlib import Path

from tests.docs.soup_page import PURPOSE, components, page

_PAGE = Path(__file__).parents[2] / "docs" / "soup.md"


def test_the_committed_page_is_generated_from_the_lock_file():
    assert _PAGE.read_text() == page(), "run `make docs`"


def test_every_component_states_a_licence_and_none_is_the_gpl():
    for one in components():
        assert one.licence, one.name
        assert "GPL" not in one.licence.replace("LGPL", ""), one.name


def test_every_use_that_is_told_is_of_a_component():
    names = [one.name for one in components()]
    assert PURPOSE.keys() <= set(names)
    assert len(names) == len(set(names)) > 60
