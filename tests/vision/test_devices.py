import tomllib
from datetime import date

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision.devices import Bead, DetectorKind, Guide, read_carm, read_guide
from vision.table import Table

# Every number of the three reference files: table, key, value as written.
GUIDE_NUMBERS = [
    (b"small_ring", b"radius", 20.0),
    (b"big_ring", b"radius", 30.0),
    (b"axis", b"separation", 60.0),
    (b"indicator_line", b"start", 26.0),
    (b"indicator_line", b"end", 66.0),
    (b"wire", b"diameter", 1.2),
    (b"bead", b"diameter", 3.0),
    (b"tolerance", b"radius_sd", 0.02),
    (b"tolerance", b"separation_sd", 0.03),
    (b"tolerance", b"bead_sd", 0.05),
    (b"tolerance", b"bore_concentricity_sd", 0.02),
]
CARM_NUMBERS = [
    (b"geometry", b"source_to_image_distance", 1000.0),
    (b"geometry", b"source_to_image_distance_sd", 30.0),
    (b"geometry", b"principal_point_sd_px", 15.0),
    (b"detector", b"field_of_view", 360.0),
    (b"plate", b"ball_spacing", 15.0),
    (b"plate", b"ball_diameter", 2.0),
]
SLIPS = [1000.0, 0.001, 57.29578, 1.0 / 57.29578]  # mm for m, and degrees for radians, either way round


def with_number(toml: bytes, table: bytes, key: bytes, value: float | str) -> bytes:
    """The file with one number replaced."""
    before, after = toml.split(b"[" + table + b"]", 1)
    lines = after.split(b"\n")
    index = next(i for i, line in enumerate(lines) if line.startswith(key + b" ="))
    lines[index] = key + b" = " + str(value).encode()
    return before + b"[" + table + b"]" + b"\n".join(lines)


def test_reference_guide_is_read_with_its_identity(guide: Guide, guide_toml: bytes) -> None:
    assert (guide.small_ring_radius_mm, guide.big_ring_radius_mm, guide.separation_mm) == (20.0, 30.0, 60.0)
    assert guide.bead == Bead((0.0, 45.0, -30.0), 3.0)
    assert guide.name == "reference-guide"
    assert guide.expires is None
    assert guide.sha256 != read_guide(guide_toml + b"# one byte more\n").sha256


def test_carm_kind_decides_about_the_plate(flat_panel_toml: bytes, intensifier_toml: bytes) -> None:
    flat, intensifier = read_carm(flat_panel_toml), read_carm(intensifier_toml)
    assert flat.detector is DetectorKind.FLAT_PANEL
    assert flat.plate is None
    assert intensifier.plate is not None
    assert intensifier.plate.ball_spacing_mm == 15.0
    with pytest.raises(ValueError, match="plate"):
        read_carm(intensifier_toml.replace(b"image-intensifier", b"flat-panel"))
    with pytest.raises(ValueError, match="plate"):
        read_carm(flat_panel_toml.replace(b"flat-panel", b"image-intensifier"))


@pytest.mark.hazard("H09")
@pytest.mark.parametrize("slip", SLIPS)
@pytest.mark.parametrize(("table", "key", "value"), GUIDE_NUMBERS)
def test_guide_number_in_the_wrong_unit_is_refused(
    guide_toml: bytes, table: bytes, key: bytes, value: float, slip: float
) -> None:
    with pytest.raises(ValueError, match=r"^(?!.*\n)"):
        read_guide(with_number(guide_toml, table, key, value * slip))


@pytest.mark.hazard("H09")
@pytest.mark.parametrize("slip", SLIPS)
@pytest.mark.parametrize(("table", "key", "value"), CARM_NUMBERS)
def test_carm_number_in_the_wrong_unit_is_refused(
    intensifier_toml: bytes, table: bytes, key: bytes, value: float, slip: float
) -> None:
    with pytest.raises(ValueError, match=r"^(?!.*\n)"):
        read_carm(with_number(intensifier_toml, table, key, value * slip))


@pytest.mark.hazard("H09")
@pytest.mark.parametrize("slip", SLIPS)
@pytest.mark.parametrize("coordinate", [1, 2])
def test_bead_coordinate_in_the_wrong_unit_is_refused(guide_toml: bytes, coordinate: int, slip: float) -> None:
    position = [0.0, 45.0, -30.0]
    position[coordinate] *= slip
    with pytest.raises(ValueError, match="Bead: position_mm"):
        read_guide(with_number(guide_toml, b"bead", b"position", str(position)))


@pytest.mark.parametrize("wrong", ["nan", "inf", "-inf", "true", '"20"', "[20.0]", "0", "-20.0", "9" * 400])
@pytest.mark.parametrize(("table", "key", "value"), GUIDE_NUMBERS)
def test_guide_number_of_another_kind_is_refused_with_one_line(
    guide_toml: bytes, table: bytes, key: bytes, value: float, wrong: str
) -> None:
    with pytest.raises(ValueError) as caught:
        read_guide(with_number(guide_toml, table, key, wrong))
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize(("table", "key", "value"), GUIDE_NUMBERS)
def test_missing_guide_number_is_named(guide_toml: bytes, table: bytes, key: bytes, value: float) -> None:
    with pytest.raises(ValueError, match=f"{key.decode()} is missing"):
        read_guide(with_number(guide_toml, table, key, value).replace(key + b" = " + str(value).encode(), b"", 1))


def test_missing_tables_are_named(guide_toml: bytes, flat_panel_toml: bytes) -> None:
    with pytest.raises(ValueError, match="tolerance is missing"):
        read_guide(guide_toml.split(b"[tolerance]")[0])
    with pytest.raises(ValueError, match="detector is missing"):
        read_carm(flat_panel_toml.split(b"[detector]")[0])


@pytest.mark.hazard("H10")
@pytest.mark.parametrize("misspelt", [b"expire = 2020-01-01", b"Expires = 2020-01-01", b"beed = {}", b"plates = {}"])
def test_a_misspelt_key_is_refused_and_the_known_ones_are_told(
    guide_toml: bytes, intensifier_toml: bytes, misspelt: bytes
) -> None:
    """Of an optional key a slip would pass for one that was left out: an expiry that never comes."""
    key = misspelt.split()[0].decode()
    for read, content in [(read_guide, guide_toml), (read_carm, intensifier_toml)]:
        with pytest.raises(ValueError, match=f": {key} is unknown; known are .*expires"):
            read(content.replace(b"version = 1", b"version = 1\n" + misspelt))


def test_guide_without_a_bead_is_legal_but_one_in_the_plane_of_symmetry_is_not(guide_toml: bytes) -> None:
    before, after = guide_toml.split(b"[bead]")
    assert read_guide(before + b"[tolerance]" + after.split(b"[tolerance]")[1]).bead is None
    with pytest.raises(ValueError, match="y = 0"):
        read_guide(guide_toml.replace(b"[0.0, 45.0, -30.0]", b"[45.0, 0.0, -30.0]"))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"radius = 20.0", b"radius = 31.0"),  # the small ring larger than the big one
        (b"start = 26.0", b"start = 67.0"),  # a line that runs backwards
        (b"version = 1", b"version = 0"),
        (b"version = 1", b"version = true"),
        (b'name = "reference-guide"', b'name = "  "'),
        (b'name = "reference-guide"', b"name = 7"),
        (b'name = "reference-guide"', rb'name = "gui\u0000de"'),  # PostgreSQL keeps no such text
        (b"version = 1", b"version = 1\nexpires = 2027-01-01T00:00:00"),
        (b"version = 1", b'version = 1\nexpires = "2027-01-01"'),
        (b"[wire]", b"wire = 3\n[bore]"),
    ],
)
def test_values_that_make_no_guide_are_refused(guide_toml: bytes, old: bytes, new: bytes) -> None:
    with pytest.raises(ValueError):
        read_guide(guide_toml.replace(old, new))


def test_expiry_is_a_date(guide_toml: bytes) -> None:
    guide = read_guide(guide_toml.replace(b"version = 1", b"version = 1\nexpires = 2027-12-31"))
    assert guide.expires == date(2027, 12, 31)


@given(st.binary(max_size=300))
def test_any_bytes_give_one_line_or_a_device(data: bytes) -> None:
    for read in (read_guide, read_carm):
        with pytest.raises(ValueError) as caught:
            read(data)
        assert len(str(caught.value).splitlines()) == 1


def test_huge_file_is_not_parsed() -> None:
    with pytest.raises(ValueError, match="larger"):
        Table.from_toml(b"a = 1\n" * 20_000, "guide file")


def test_the_tests_cover_every_number_of_the_files(guide_toml: bytes, intensifier_toml: bytes) -> None:
    for toml, listed in ((guide_toml, GUIDE_NUMBERS), (intensifier_toml, CARM_NUMBERS)):
        tables = {key: value for key, value in tomllib.loads(toml.decode()).items() if isinstance(value, dict)}
        found = {(t, k) for t, values in tables.items() for k, v in values.items() if isinstance(v, float)}
        assert found == {(table.decode(), key.decode()) for table, key, _ in listed}
