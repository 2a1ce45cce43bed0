"""C-STORE of one object, and the archive's answer."""

from dataclasses import dataclass
from io import BytesIO

from pydicom import Dataset, dcmread
from pynetdicom.association import Association

_SUCCESS = 0x0000
# PS3.4 B.2.3: stored, with a warning about some attributes.
_STORED_WITH_WARNING = (0xB000, 0xB006, 0xB007)


@dataclass(frozen=True, slots=True)
class Stored:
    """What became of an object; `comment` is the archive's own text, in which it may have named the patient."""

    accepted: bool
    status: str
    comment: str = ""

    @property
    def words(self) -> str:
        """The whole answer, for the record alone."""
        return f"{self.status} {self.comment}".strip()


def store(association: Association, content: bytes) -> Stored:
    """Send one DICOM file."""
    try:
        answer: Dataset = association.send_c_store(dcmread(BytesIO(content)))
    except (ValueError, RuntimeError) as error:  # no accepted context for this class; the association is gone
        return Stored(False, "not sent", str(error).splitlines()[0])
    if "Status" not in answer:
        return Stored(False, "no answer")
    accepted = answer.Status == _SUCCESS or answer.Status in _STORED_WITH_WARNING
    return Stored(accepted, f"status 0x{answer.Status:04X}", str(answer.get("ErrorComment") or ""))
