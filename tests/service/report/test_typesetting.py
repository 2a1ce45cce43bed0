"""The page as it is set: PDF/A, every writing, and text that is never taken for markup."""

import hashlib
from io import BytesIO
from pathlib import Path

import pytest
from hatchling.builders.wheel import WheelBuilder
from pypdf import PdfReader

from service.report.fonts import printable
from service.report.typesetting import TEMPLATE, typeset

_DATED = "2026-11-22T11:47:48.123456Z"
_HOSTILE = '#eval("1+1") *bold* $x^2$ @ref <label> \\ // #panic()'
_WRITINGS = ("Ünal Žižka Đặng", "Иванов", "Ελένη", "山田太郎", "王小明", "김철수", "ไทย", "Հայ", "ქართ")
_TIMES = 5  # in the head of each of three pages, among the facts and among the stops
_RIGHT_TO_LEFT = ("محمد", "שלום")


def _document(patient: str) -> dict:
    head = ("case_id", "patient_id", "state", "state_words", "program", "as_of")
    tables = ("facts", "outcomes", "totals", "devices", "sources", "targets", "other_exposures", "failures")
    tables += ("interlocks", "overrides", "stops", "statements", "signatures", "proof")
    return (
        {"head": {name: name for name in head} | {"patient": patient}, "decided": "none"}
        | {name: [] for name in tables}
        | {"facts": [["Patient", patient]], "stops": [["11:47", "anna", "stop", patient, "safe hold"]]}
    )


def _text(pdf: bytes) -> str:
    return " ".join(" ".join(page.extract_text() for page in PdfReader(BytesIO(pdf)).pages).split())


def test_text_that_looks_like_markup_is_printed_as_it_is():
    assert _text(typeset(_document(_HOSTILE), {}, _DATED)).count(_HOSTILE) == _TIMES


@pytest.fixture(scope="module")
def in_every_writing() -> bytes:
    return typeset(_document(" ".join((*_WRITINGS, *_RIGHT_TO_LEFT))), {}, _DATED)


def test_names_of_every_writing_are_printed(in_every_writing):
    text = _text(in_every_writing)
    for name in _WRITINGS:
        assert text.count(name) == _TIMES, name
    for name in _RIGHT_TO_LEFT:
        assert name in text or name[::-1] in text, name
    assert "[U+" not in text


def test_it_says_that_it_is_pdf_a_and_embeds_what_that_needs(in_every_writing):
    reader = PdfReader(BytesIO(in_every_writing))
    root = reader.trailer["/Root"]
    metadata = root["/Metadata"].get_data().decode()
    assert "<pdfaid:part>2</pdfaid:part>" in metadata
    assert "<pdfaid:conformance>B</pdfaid:conformance>" in metadata
    assert root["/OutputIntents"][0]["/S"] == "/GTS_PDFA1"
    assert not reader.is_encrypted
    fonts = [font.get_object() for page in reader.pages for font in page["/Resources"]["/Font"].values()]
    assert len(fonts) >= 5
    for font in fonts:
        (descendant,) = font["/DescendantFonts"]
        assert {"/FontFile2", "/FontFile3"} & descendant["/FontDescriptor"].keys()
        assert "/ToUnicode" in font


def test_the_same_document_gives_the_same_bytes_and_another_date_others(in_every_writing):
    document = _document(" ".join((*_WRITINGS, *_RIGHT_TO_LEFT)))
    again, later = typeset(document, {}, _DATED), typeset(document, {}, "2026-11-23T00:00:00Z")
    assert hashlib.sha256(again).digest() == hashlib.sha256(in_every_writing).digest()
    assert later != again


def test_what_no_font_has_is_printed_as_its_code_point_and_said():
    text = _text(typeset(_document("த Doe"), {}, _DATED))
    assert "[U+0BA4] Doe" in text
    assert "no glyph are printed as code points in brackets: U+0BA4." in text


def test_an_installed_program_has_the_template():
    tree = Path(__file__).parents[3]
    packed = {file.distribution_path for file in WheelBuilder(str(tree)).recurse_included_files()}
    assert TEMPLATE.relative_to(tree).as_posix() in packed


@pytest.mark.parametrize(
    ("given", "told", "missing"),
    [
        ("Doe\tJane\n2", "Doe Jane 2", []),
        ("a\N{NO-BREAK SPACE}b", "a\N{NO-BREAK SPACE}b", []),
        ("eno\N{RIGHT-TO-LEFT OVERRIDE}b", "eno[U+202E]b", ["U+202E"]),
        ("a\x00b\x1b", "a[U+0000]b[U+001B]", ["U+0000", "U+001B"]),
        ("a\N{ZERO WIDTH SPACE}b", "a[U+200B]b", ["U+200B"]),
        ("می\N{ZERO WIDTH NON-JOINER}خواهم", "می\N{ZERO WIDTH NON-JOINER}خواهم", []),
        ("\ud800", "[U+D800]", ["U+D800"]),
    ],
)
def test_what_cannot_be_seen_is_told(given, told, missing):
    assert printable({"a": [given, None]}) == ({"a": [told, None]}, missing)
