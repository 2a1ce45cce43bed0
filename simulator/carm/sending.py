"""The C-arm's network: one association an image, by C-STORE."""

from dataclasses import dataclass
from io import BytesIO

from pydicom.dataset import Dataset
from pydicom.uid import ExplicitVRLittleEndian, XRayAngiographicImageStorage
from pynetdicom import AE, Association
from pynetdicom.dimse_messages import C_STORE_RQ
from pynetdicom.dimse_primitives import C_STORE
from pynetdicom.dsutils import encode

_OWN_TITLE = "CARM"
_TIMEOUT_S = 30.0
_STATUS_SUCCESS = 0x0000


@dataclass(frozen=True, slots=True)
class Destination:
    """Where images go."""

    host: str
    port: int
    ae_title: str


@dataclass(frozen=True, slots=True)
class Sent:
    """What became of an image: the receiver's status, or why there is none."""

    accepted: bool
    status: int | None
    detail: str


def send(dataset: Dataset, destination: Destination) -> Sent:
    """Store an image at its destination and wait for the answer."""
    association = _associate(destination)
    if not association.is_established:
        return Sent(False, None, f"no association with {destination.ae_title} at {destination.host}:{destination.port}")
    try:
        answer = association.send_c_store(dataset)
    finally:
        association.release()
    status = answer.get("Status")
    if status is None:
        return Sent(False, None, "the receiver did not answer")
    return Sent(status == _STATUS_SUCCESS, int(status), str(answer.get("ErrorComment", "")))


def send_truncated(dataset: Dataset, destination: Destination) -> Sent:
    """Begin to store an image and let the network break half way."""
    association = _associate(destination)
    if not association.is_established:
        return Sent(False, None, "no association")
    context = association.accepted_contexts[0].context_id
    message = C_STORE_RQ()
    message.primitive_to_message(_request(dataset))
    parts = list(message.encode_msg(context, association.acceptor.maximum_length))
    for part in parts[: len(parts) // 2]:
        association.dul.send_pdu(part)
    association.abort()
    return Sent(False, None, "the association broke in the middle of the image")


def _associate(destination: Destination) -> Association:
    entity = AE(ae_title=_OWN_TITLE)
    entity.acse_timeout = entity.dimse_timeout = entity.network_timeout = _TIMEOUT_S
    entity.connection_timeout = _TIMEOUT_S
    entity.add_requested_context(XRayAngiographicImageStorage, ExplicitVRLittleEndian)
    return entity.associate(destination.host, destination.port, ae_title=destination.ae_title)


def _request(dataset: Dataset) -> C_STORE:
    request = C_STORE()
    request.MessageID = 1
    request.AffectedSOPClassUID = dataset.SOPClassUID
    request.AffectedSOPInstanceUID = dataset.SOPInstanceUID
    request.Priority = 2
    syntax = dataset.file_meta.TransferSyntaxUID
    request.DataSet = BytesIO(encode(dataset, syntax.is_implicit_VR, syntax.is_little_endian) or b"")
    return request
