"""List and bill of components are the lock file's, each with a licence that may be shipped and a use."""

import json
import re
import subprocess
import sys
from pathlib import Path

from tests.docs.soup_page import PURPOSE, components, page

_ROOT = Path(__file__).parents[2]
_PAGE = _ROOT / "docs" / "soup.md"


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


def test_the_bill_of_materials_has_every_locked_library_with_the_hashes_of_its_files(tmp_path):
    """What `make sbom` writes; the environment is the one that runs this."""
    file, environment = tmp_path / "sbom.json", f"VENV={sys.prefix}"
    command = ["make", "-C", _ROOT, f"--old-file={sys.prefix}/.test", "sbom", environment, f"FILE={file}"]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    bill = json.loads(file.read_text())
    assert (bill["bomFormat"], bill["metadata"]["component"]["name"]) == ("CycloneDX", "coaxial")
    assert {(one["name"], one["version"]): _hashes(one) for one in bill["components"]} == _locked()


def _hashes(component: dict) -> set[str]:
    (files,) = component["externalReferences"]
    return {one["content"] for one in files["hashes"]}


def _locked() -> dict[tuple[str, str], set[str]]:
    """Hashes of the files of each library, whatever machine they are for."""
    libraries = re.split(r"^(?=[\w.-]+==)", (_ROOT / "requirements.lock").read_text(), flags=re.MULTILINE)[1:]
    return {tuple(one.split()[0].split("==")): set(re.findall(r"sha256:(\w+)", one)) for one in libraries}
