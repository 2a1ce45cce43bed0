"""Settings: order of the sources, and no misspelt limit that silently keeps its default."""

from pathlib import Path

import pytest

from service.errors import ErrorCode, ServiceError
from service.settings import Settings, load_settings


def _file(tmp_path: Path, text: str) -> Path:
    file = tmp_path / "coaxial.toml"
    file.write_text(text)
    return file


def test_the_file_beats_defaults_the_environment_the_file_and_arguments_all(tmp_path, monkeypatch):
    file = _file(tmp_path, 'room = "theatre-2"\n[http]\nport = 9001\n[dicom]\nae_title = "FILE"\n')
    monkeypatch.setenv("COAXIAL_DICOM__AE_TITLE", "ENVIRONMENT")
    settings = load_settings(file, {"http": {"port": 0}})
    assert (settings.room, settings.http.port, settings.dicom.ae_title) == ("theatre-2", 0, "ENVIRONMENT")
    assert settings.http.host == "127.0.0.1", "a partly given section keeps its other defaults"


@pytest.mark.parametrize(
    "text",
    [
        "[limits]\nangle_eror_deg = 9.0\n",
        "[limits]\nangle_error_deg = -1.0\n",
        "[limits]\nposition_error_mm = 1500.0\n",
        "[limits]\npermit_s = 31.0\n",
        "rooom = 'x'\n",
        "[http\nport = 1\n",
        "[http]\nport = 99999\n",
    ],
)
def test_a_wrong_settings_file_is_refused_and_named(tmp_path, text):
    with pytest.raises(ServiceError) as refusal:
        load_settings(_file(tmp_path, text))
    assert refusal.value.code == ErrorCode.SETTINGS_REFUSED


def test_a_misspelt_setting_and_a_file_that_is_no_toml_are_told_in_plain_words(tmp_path):
    with pytest.raises(ServiceError, match=r"setting limits\.angle_eror_deg: there is no such setting$"):
        load_settings(_file(tmp_path, "[limits]\nangle_eror_deg = 1.0\n"))
    with pytest.raises(ServiceError, match=r"coaxial\.toml cannot be read: .*line 1"):
        load_settings(_file(tmp_path, "room = \n"))


@pytest.mark.parametrize(("name", "text"), [("COAXIAL_LIMITS__ANGLE_ERROR_DEG", "90"), ("COAXIAL_LIMITS", "{")])
def test_a_wrong_environment_is_refused(monkeypatch, name, text):
    monkeypatch.setenv(name, text)
    with pytest.raises(ServiceError) as refusal:
        load_settings(None)
    assert refusal.value.code == ErrorCode.SETTINGS_REFUSED


@pytest.mark.parametrize("url", ["secret", "mysql://a:secret@host/name", "sqlite://", "postgresql://a:secret@host:x/y"])
def test_a_database_that_nothing_here_opens_is_refused_without_its_password(tmp_path, url):
    with pytest.raises(ServiceError, match="database_url") as refusal:
        load_settings(_file(tmp_path, f'database_url = "{url}"'))
    assert "secret" not in refusal.value.message


def test_a_missing_settings_file_is_refused(tmp_path):
    with pytest.raises(ServiceError, match="does not exist"):
        load_settings(tmp_path / "none.toml")


def test_the_database_is_in_the_data_folder_unless_it_is_named(tmp_path):
    assert str(tmp_path) in Settings(data_folder=tmp_path).database_url
    assert Settings(data_folder=tmp_path, database_url="sqlite:///other").database_url == "sqlite:///other"


def test_the_fingerprint_changes_with_a_limit_and_not_with_a_folder(tmp_path):
    base = Settings(data_folder=tmp_path)
    assert base.fingerprint() == Settings(data_folder=tmp_path / "moved").fingerprint()
    assert base.fingerprint() != Settings(data_folder=tmp_path, limits={"angle_error_deg": 1.1}).fingerprint()
