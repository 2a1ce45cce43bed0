"""C-STORE of one object, and the archive's answer."""

from io import BytesIO

from pydicom import Dataset, dcmread
from pynetdicom.association import Association

_SUCCESS = 0x0000
# PS3.4 B.2.3: stored, with a warning about some attributes.
_STORED_WITH_WARNING = (0xB000, 0xB006, 0xB007)


def store(association: Association, content: bytes) -> tuple[bool, str]:
    """Send one DICOM file; whether it was stored, and the answer in words."""
    try:
        answer: Dataset = association.send_c_store(dcmread(BytesIO(content)))
    except (ValueError, RuntimeError) as error:  # no accepted context for this class; the association is gone
        return False, str(error).splitlines()[0]
    if "Status" not in answer:
        return False, "no answer"
    stored = answer.Status == _SUCCESS or answer.Status in _STORED_WITH_WARNING
    return stored, f"status 0x{answer.Status:04X} {answer.get('ErrorComment') or ''}".strip()
