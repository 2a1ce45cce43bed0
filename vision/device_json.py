"""Guide and C-arm inside a registration's JSON, so that the registration can be used without the device files."""

from datetime import date
from typing import Any

from vision.devices import Bead, CArm, DetectorKind, Guide, GuideTolerance, Plate
from vision.table import Table

_HEX_DIGITS = frozenset("0123456789abcdef")
_GREATEST_VERSION = 1_000_000


def guide_to_json(guide: Guide) -> dict[str, Any]:
    """Every field of the guide, by its own name."""
    bead, tolerance = guide.bead, guide.tolerance
    return _identity_to_json(guide) | {
        "small_ring_radius_mm": guide.small_ring_radius_mm,
        "big_ring_radius_mm": guide.big_ring_radius_mm,
        "separation_mm": guide.separation_mm,
        "line_start_mm": guide.line_start_mm,
        "line_end_mm": guide.line_end_mm,
        "wire_diameter_mm": guide.wire_diameter_mm,
        "bead": None if bead is None else {"position_mm": list(bead.position_mm), "diameter_mm": bead.diameter_mm},
        "tolerance": {
            "radius_sd_mm": tolerance.radius_sd_mm,
            "separation_sd_mm": tolerance.separation_sd_mm,
            "bead_sd_mm": tolerance.bead_sd_mm,
            "bore_concentricity_sd_mm": tolerance.bore_concentricity_sd_mm,
        },
    }


def guide_from_json(table: Table) -> Guide:
    """The guide; ValueError with one line if anything is missing or implausible."""
    tolerance = table.table("tolerance")
    return Guide(
        name=table.text("name"),
        version=table.integer("version", 1, _GREATEST_VERSION),
        sha256=sha256_from_json(table),
        expires=_expires(table),
        small_ring_radius_mm=table.number("small_ring_radius_mm"),
        big_ring_radius_mm=table.number("big_ring_radius_mm"),
        separation_mm=table.number("separation_mm"),
        line_start_mm=table.number("line_start_mm"),
        line_end_mm=table.number("line_end_mm"),
        wire_diameter_mm=table.number("wire_diameter_mm"),
        bead=None if table.get("bead") is None else _bead(table.table("bead")),
        tolerance=GuideTolerance(
            radius_sd_mm=tolerance.number("radius_sd_mm"),
            separation_sd_mm=tolerance.number("separation_sd_mm"),
            bead_sd_mm=tolerance.number("bead_sd_mm"),
            bore_concentricity_sd_mm=tolerance.number("bore_concentricity_sd_mm"),
        ),
    )


def _bead(table: Table) -> Bead:
    x_mm, y_mm, z_mm = (float(value) for value in table.numbers("position_mm", 3))
    return Bead(position_mm=(x_mm, y_mm, z_mm), diameter_mm=table.number("diameter_mm"))


def carm_to_json(carm: CArm) -> dict[str, Any]:
    """Every field of the C-arm, by its own name."""
    plate = carm.plate
    return _identity_to_json(carm) | {
        "source_to_image_mm": carm.source_to_image_mm,
        "source_to_image_sd_mm": carm.source_to_image_sd_mm,
        "principal_point_sd_px": carm.principal_point_sd_px,
        "detector": carm.detector.value,
        "field_of_view_mm": carm.field_of_view_mm,
        "plate": None
        if plate is None
        else {"ball_spacing_mm": plate.ball_spacing_mm, "ball_diameter_mm": plate.ball_diameter_mm},
    }


def carm_from_json(table: Table) -> CArm:
    """The C-arm; ValueError with one line if anything is missing or implausible."""
    detector = table.text("detector")
    if detector not in tuple(DetectorKind):
        raise ValueError(f"{table.where}: detector must be one of {', '.join(DetectorKind)}")
    return CArm(
        name=table.text("name"),
        version=table.integer("version", 1, _GREATEST_VERSION),
        sha256=sha256_from_json(table),
        expires=_expires(table),
        source_to_image_mm=table.number("source_to_image_mm"),
        source_to_image_sd_mm=table.number("source_to_image_sd_mm"),
        principal_point_sd_px=table.number("principal_point_sd_px"),
        detector=DetectorKind(detector),
        field_of_view_mm=table.number("field_of_view_mm"),
        plate=None if table.get("plate") is None else _plate(table.table("plate")),
    )


def _plate(table: Table) -> Plate:
    return Plate(ball_spacing_mm=table.number("ball_spacing_mm"), ball_diameter_mm=table.number("ball_diameter_mm"))


def sha256_from_json(table: Table) -> str:
    """The table's `sha256`: 64 lower-case hexadecimal digits."""
    digest = table.text("sha256")
    if len(digest) != 64 or not _HEX_DIGITS.issuperset(digest):
        raise ValueError(f"{table.where}: sha256 must be 64 hexadecimal digits")
    return digest


def _identity_to_json(device: Guide | CArm) -> dict[str, Any]:
    expires = device.expires.isoformat() if device.expires else None
    return {"name": device.name, "version": device.version, "sha256": device.sha256, "expires": expires}


def _expires(table: Table) -> date | None:
    if table.get("expires") is None:
        return None
    try:
        return date.fromisoformat(table.text("expires"))
    except ValueError as error:
        raise ValueError(f"{table.where}: expires must be a date, as in 2027-12-31") from error
