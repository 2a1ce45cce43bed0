"""X-ray images in every usual transfer syntax: sent by storescu, stored, decoded to the pixels that were meant."""

import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pydicom import dcmread
from pydicom.encaps import encapsulate, generate_frames
from pydicom.uid import (
    JPEG2000,
    UID,
    ComputedRadiographyImageStorage,
    DigitalXRayImageStorageForPresentation,
    JPEG2000Lossless,
    SecondaryCaptureImageStorage,
    XRayAngiographicImageStorage,
    XRayRadiofluoroscopicImageStorage,
)

from service.database.engines import open_database
from service.images import store
from service.images.arrivals import ImageArrivals
from service.images.receiver import DicomReceiver
from service.settings import DicomSettings
from vision.refusal import Refusal, RefusalCode
from vision.xray import XrayImage, decode

_ROWS, _COLUMNS = 300, 260
_KINDS = {
    "XA": XRayAngiographicImageStorage,
    "RF": XRayRadiofluoroscopicImageStorage,
    "CR": ComputedRadiographyImageStorage,
    "DX": DigitalXRayImageStorageForPresentation,
    "OT": SecondaryCaptureImageStorage,  # the modality that a secondary capture of an X-ray usually has
}
Make = Callable[[Path], Path]


def _with(*command: str) -> Make:
    """Have a program of dcmtk's write the file anew."""

    def make(file: Path) -> Path:
        made = file.with_suffix(".made.dcm")
        subprocess.run([command[0], *command[1:], str(file), str(made)], check=True, capture_output=True, timeout=60)
        return made

    return make


def _jpeg2000(file: Path, syntax: UID, **options: object) -> Path:
    """dcmtk encodes no JPEG 2000; Pillow does."""
    dataset, codestream = dcmread(file), BytesIO()
    Image.fromarray(dataset.pixel_array).save(codestream, "JPEG2000", no_jp2=True, **options)
    dataset.file_meta.TransferSyntaxUID = syntax
    dataset.PixelData = encapsulate([codestream.getvalue()])
    dataset["PixelData"].VR = "OB"
    made = file.with_suffix(".made.dcm")
    dataset.save_as(made, enforce_file_format=True)
    return made


def _original(file: Path) -> np.ndarray:
    return dcmread(file).pixel_array


def _by_dcmdjpeg(file: Path) -> np.ndarray:
    """What dcmtk makes of it."""
    return _original(_with("dcmdjpeg")(file))


def _by_dcmdjpls(file: Path) -> np.ndarray:
    return _original(_with("dcmdjpls")(file))


def _by_pillow(file: Path) -> np.ndarray:
    (frame,) = generate_frames(dcmread(file).PixelData, number_of_frames=1)
    return np.asarray(Image.open(BytesIO(frame)))


@dataclass(frozen=True)
class Syntax:
    """How a file of it is made and proposed; of one that loses pixels, an independent decoder."""

    uid: str
    proposed_by: str
    make: Make
    bits: int = 12
    decoder: Callable[[Path], np.ndarray] | None = None


SYNTAXES = {
    "implicit": Syntax("1.2.840.10008.1.2", "-xi", _with("dcmconv", "+ti")),
    "explicit": Syntax("1.2.840.10008.1.2.1", "-xe", _with("dcmconv", "+te"), bits=16),
    "deflated": Syntax("1.2.840.10008.1.2.1.99", "-xd", _with("dcmconv", "+td"), bits=10),
    "big endian": Syntax("1.2.840.10008.1.2.2", "-xb", _with("dcmconv", "+tb"), bits=14),
    "RLE": Syntax("1.2.840.10008.1.2.5", "-xr", _with("dcmcrle")),
    "JPEG baseline": Syntax("1.2.840.10008.1.2.4.50", "-xy", _with("dcmcjpeg", "+eb"), 8, _by_dcmdjpeg),
    "JPEG extended": Syntax("1.2.840.10008.1.2.4.51", "-xx", _with("dcmcjpeg", "+ee"), 12, _by_dcmdjpeg),
    "JPEG lossless": Syntax("1.2.840.10008.1.2.4.57", "-xf", _with("dcmcjpeg", "+el", "+sv", "6"), bits=16),
    "JPEG lossless SV1": Syntax("1.2.840.10008.1.2.4.70", "-xs", _with("dcmcjpeg", "+e1")),
    "JPEG-LS": Syntax("1.2.840.10008.1.2.4.80", "-xt", _with("dcmcjpls", "+el"), bits=14),
    "JPEG-LS lossy": Syntax("1.2.840.10008.1.2.4.81", "-xu", _with("dcmcjpls", "+en"), 12, _by_dcmdjpls),
    "JPEG 2000 lossless": Syntax("1.2.840.10008.1.2.4.90", "-xv", partial(_jpeg2000, syntax=JPEG2000Lossless)),
    "JPEG 2000": Syntax(
        "1.2.840.10008.1.2.4.91",
        "-xw",
        partial(_jpeg2000, syntax=JPEG2000, irreversible=True, quality_layers=[8]),
        12,
        _by_pillow,
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Room:
    """A receiver, and what it stored."""

    port: int
    newest: Callable[[], tuple[store.StoredImage, bytes]]


@pytest.fixture(scope="module")
def room(tmp_path_factory, databases) -> Iterator[Room]:
    with databases.migrated(tmp_path_factory.mktemp("room")) as address:
        database = open_database(address)

        def newest() -> tuple[store.StoredImage, bytes]:
            with database.read() as connection:
                image = store.list_images(connection, limit=1)[0]
                return image, store.original_bytes(connection, image.id)

        settings = DicomSettings(port=0, accepted_callers=("CARM",))
        with DicomReceiver(settings, database, ImageArrivals(), lambda: None).listening() as port:
            yield Room(port, newest)
        database.close()


def _shadows(bits: int, seed: int) -> np.ndarray:
    """Grey values as an image has them: a slope, an edge, noise; the whole range."""
    rows, columns = np.mgrid[0:_ROWS, 0:_COLUMNS]
    noise = np.random.default_rng(seed).normal(0.0, 0.01, (_ROWS, _COLUMNS))
    share = np.clip(0.2 + 0.5 * rows / _ROWS + 0.25 * (columns > 100) + noise, 0.0, 1.0)
    share[0, :2] = 0.0, 1.0
    return np.round(share * (2**bits - 1)).astype(np.uint8 if bits == 8 else np.uint16)


@pytest.fixture
def send(room, storescu, make_xray, tmp_path) -> Callable[..., Path]:
    """Make a file, send it and have it stored; the file."""

    def one(syntax: Syntax, modality: str, values: np.ndarray, **elements: object) -> Path:
        bits = {"BitsAllocated": 8 * values.itemsize, "BitsStored": syntax.bits, "HighBit": syntax.bits - 1}
        said = {
            "SOPClassUID": _KINDS[modality],
            "Modality": modality,
            "PixelData": values.tobytes(),
            **bits,
            **elements,
        }
        plain = tmp_path / "plain.dcm"
        plain.write_bytes(make_xray(_ROWS, _COLUMNS, **said))
        file = syntax.make(plain)
        proposed = [syntax.proposed_by, *(_profile(tmp_path) if syntax.proposed_by == "-xf" else ())]
        command = [storescu, *proposed, "-aet", "CARM", "127.0.0.1", str(room.port), str(file)]
        sent = subprocess.run(command, capture_output=True, text=True, timeout=60)
        assert sent.returncode == 0, sent.stderr
        return file

    return one


def _profile(folder: Path) -> tuple[str, str]:
    """storescu has no option for process 14 with other predictors than the first: a file says so, and its profile."""
    contexts = "\n".join(f"PresentationContext{n} = {one}\\P14" for n, one in enumerate(_KINDS.values(), 1))
    file = folder / "storescu.cfg"
    file.write_text(
        f"[[TransferSyntaxes]]\n[P14]\nTransferSyntax1 = 1.2.840.10008.1.2.4.57\n"
        f"[[PresentationContexts]]\n[ALL]\n{contexts}\n[[Profiles]]\n[SEND]\nPresentationContexts = ALL\n"
    )
    return str(file), "SEND"


@pytest.mark.parametrize("name", SYNTAXES)
def test_an_image_is_stored_in_its_syntax_and_decoded_to_its_pixels(room, send, name) -> None:
    syntax, number = SYNTAXES[name], list(SYNTAXES).index(name)
    values = _shadows(syntax.bits, number)
    file = send(syntax, list(_KINDS)[number % len(_KINDS)], values)
    image, content = room.newest()
    assert dcmread(BytesIO(content)).file_meta.TransferSyntaxUID == syntax.uid
    assert (image.problem, image.metadata["lossy"]) == (None, syntax.decoder is not None)
    decoded = decode(content)
    assert isinstance(decoded, XrayImage), decoded
    found = np.round(decoded.pixels * (2**syntax.bits - 1)).astype(int)
    meant = values if syntax.decoder is None else syntax.decoder(file)
    np.testing.assert_array_equal(found, np.clip(meant, 0, 2**syntax.bits - 1))
    assert np.abs(found - values).max() < 0.1 * 2**syntax.bits, "a picture of what was sent"


@pytest.mark.parametrize("modality", _KINDS)
def test_every_kind_of_x_ray_is_stored_and_decoded_in_both_polarities(room, send, modality) -> None:
    photometric = f"MONOCHROME{1 + list(_KINDS).index(modality) % 2}"
    values = _shadows(12, 100 + len(modality + photometric))
    send(SYNTAXES["JPEG lossless SV1"], modality, values, PhotometricInterpretation=photometric)
    image, content = room.newest()
    assert image.metadata["modality"] == modality
    decoded = decode(content)
    assert isinstance(decoded, XrayImage)
    shown = np.round(decoded.pixels * 4095).astype(int)
    np.testing.assert_array_equal(shown if photometric == "MONOCHROME2" else 4095 - shown, values)


@pytest.mark.hazard("H31")
@pytest.mark.parametrize("size", [(_ROWS - 30, _COLUMNS), (_ROWS + 300, _COLUMNS), (_COLUMNS, _ROWS + 1)])
@pytest.mark.parametrize("name", SYNTAXES)
def test_a_header_of_another_size_than_the_pixels_is_refused(make_xray, tmp_path, name, size) -> None:
    syntax = SYNTAXES[name]
    values, plain = _shadows(syntax.bits, 7), tmp_path / "plain.dcm"
    bits = {"BitsAllocated": 8 * values.itemsize, "BitsStored": syntax.bits, "HighBit": syntax.bits - 1}
    plain.write_bytes(make_xray(_ROWS, _COLUMNS, PixelData=values.tobytes(), **bits))
    dataset = dcmread(syntax.make(plain))
    dataset.Rows, dataset.Columns = size
    changed = BytesIO()
    dataset.save_as(changed, enforce_file_format=True)
    refusal = decode(changed.getvalue())
    assert isinstance(refusal, Refusal)
    assert (refusal.code, "size" in refusal.message) == (RefusalCode.UNREADABLE_IMAGE, True)


@pytest.mark.hazard("H31")
@pytest.mark.parametrize(
    ("name", "marker", "behind", "bytes_there"),
    [
        ("JPEG lossless SV1", b"\xff\xc4", 0, b"\xf7"),  # no marker
        ("JPEG lossless SV1", b"\xff\xc4", 5, b"\xff"),  # more codes of one bit than there are
        ("JPEG lossless SV1", b"\xff\xc4", 2, b"\x00\x03"),  # a table of one byte
        ("JPEG lossless SV1", b"\xff\xc4", 1, b"\x01"),  # a marker that has no content
        ("JPEG lossless SV1", b"\xff\xc4", 1, b"\xe4"),  # no table at all
        ("JPEG lossless SV1", b"\xff\xc3", 4, b"\xff"),  # 255 bits
        ("JPEG extended", b"\xff\xc1", 4, b"\x11"),  # 17 bits
        ("JPEG-LS", b"\xff\xf7", 4, b"\x12"),  # 18 bits
        ("JPEG lossless SV1", b"\xff\xc3", 9, b"\x03"),  # colours
        ("JPEG 2000 lossless", b"\xff\x4f\xff\x51", 24, bytes(8)),  # tiles without a size
    ],
    ids=["marker", "codes", "table", "alone", "no table", "255 bits", "17 bits", "18 bits", "colours", "tiles"],
)
def test_a_stream_of_a_senseless_header_is_refused(make_xray, tmp_path, name, marker, behind, bytes_there) -> None:
    plain = tmp_path / "plain.dcm"
    plain.write_bytes(make_xray(_ROWS, _COLUMNS, PixelData=_shadows(12, 3).tobytes()))
    content = bytearray(SYNTAXES[name].make(plain).read_bytes())
    at = content.index(marker, content.index(b"\xfe\xff\x00\xe0")) + behind
    content[at : at + len(bytes_there)] = bytes_there
    refusal = decode(bytes(content))
    assert isinstance(refusal, Refusal)
    assert refusal.code == RefusalCode.UNREADABLE_IMAGE


@pytest.mark.hazard("H31")
@pytest.mark.parametrize("name", [name for name in SYNTAXES if name.startswith("JPEG")])
def test_a_stream_without_its_end_is_refused(make_xray, tmp_path, name) -> None:
    plain, bits = tmp_path / "plain.dcm", SYNTAXES[name].bits
    values = _shadows(bits, 5)
    said = {"BitsAllocated": 8 * values.itemsize, "BitsStored": bits, "HighBit": bits - 1}
    plain.write_bytes(make_xray(_ROWS, _COLUMNS, PixelData=values.tobytes(), **said))
    refusal = decode(_changed(SYNTAXES[name].make(plain), lambda frame: frame[: len(frame) // 2]))
    assert isinstance(refusal, Refusal), "half an image, and the rest made up"
    assert refusal.code == RefusalCode.UNREADABLE_IMAGE


@pytest.mark.hazard("H31")
@pytest.mark.parametrize("name", ["JPEG baseline", "JPEG lossless", "JPEG lossless SV1"])
def test_a_header_of_fewer_bits_than_the_stream_leaves_the_process_alive(make_xray, tmp_path, name) -> None:
    """GDCM called abort() over it."""
    plain, values = tmp_path / "plain.dcm", _shadows(8, 5) // 2
    said = {"BitsAllocated": 8, "BitsStored": 8, "HighBit": 7}
    plain.write_bytes(make_xray(_ROWS, _COLUMNS, PixelData=values.tobytes(), **said))
    dataset, changed = dcmread(SYNTAXES[name].make(plain)), BytesIO()
    dataset.BitsStored, dataset.HighBit = 7, 6
    dataset.save_as(changed, enforce_file_format=True)
    decoded = decode(changed.getvalue())
    assert isinstance(decoded, XrayImage), decoded
    assert decoded.bits == 7
    if name != "JPEG baseline":
        np.testing.assert_array_equal(np.round(decoded.pixels * 127).astype(int), values)


def _changed(file: Path, change: Callable[[bytes], bytes]) -> bytes:
    """The file's content with its one frame changed."""
    dataset, changed = dcmread(file), BytesIO()
    (frame,) = generate_frames(dataset.PixelData, number_of_frames=1)
    dataset.PixelData = encapsulate([change(frame)])
    dataset.save_as(changed, enforce_file_format=True)
    return changed.getvalue()
