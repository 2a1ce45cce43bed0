"""A file is there whole or as it was."""

from pathlib import Path

import pytest

from service.whole_file import whole_file


def test_the_new_content_takes_the_old_ones_place_and_nothing_is_left_beside_it(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("old")
    with whole_file(file) as part:
        part.write_text("new")
        assert file.read_text() == "old"
    assert file.read_text() == "new"
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("error", [OSError, KeyboardInterrupt])
def test_whatever_is_raised_within_leaves_the_file_as_it_was(tmp_path: Path, error: type[BaseException]) -> None:
    file = tmp_path / "file"
    file.write_text("old")

    def fail(part: Path) -> None:
        part.write_text("ne")
        raise error

    with pytest.raises(error), whole_file(file) as part:
        fail(part)
    assert file.read_text() == "old"
    assert list(tmp_path.iterdir()) == [file]


def test_content_name_and_folder_are_on_the_disk_in_this_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file, done = tmp_path / "file", []
    monkeypatch.setattr("os.fsync", lambda opened: done.append(Path(f"/proc/self/fd/{opened}").resolve()))
    with whole_file(file) as part:
        part.write_text("new")
    assert done == [part, tmp_path.resolve()]
