"""An association with one of the hospital's DICOM peers, or a typed no."""

import socket
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from pydicom.uid import ExplicitVRLittleEndian, ImplicitVRLittleEndian
from pynetdicom import AE
from pynetdicom.association import Association

from service.errors import ErrorCode, ServiceError
from service.settings import PeerSettings

_TIMEOUT_S = 15.0


@contextmanager
def association_with(
    peer: PeerSettings, calling: str, sop_classes: Sequence[str], within_s: float = _TIMEOUT_S
) -> Iterator[Association]:
    """An association for these SOP classes; ServiceError PEER_UNKNOWN, PEER_UNREACHABLE where there is none.

    Each step and each answer may take `within_s`.
    """
    if peer.host is None:
        raise ServiceError(ErrorCode.PEER_UNKNOWN, "the settings name no host of this peer")
    _knock(peer.host, peer, within_s)
    entity = AE(ae_title=calling)
    for sop_class in dict.fromkeys(sop_classes):
        entity.add_requested_context(sop_class, [ExplicitVRLittleEndian, ImplicitVRLittleEndian])
    entity.acse_timeout = entity.dimse_timeout = entity.network_timeout = entity.connection_timeout = within_s
    association = entity.associate(peer.host, peer.port, ae_title=peer.ae_title)
    if not association.is_established:
        told = "refuses" if association.is_rejected else "does not answer"
        raise ServiceError(ErrorCode.PEER_UNREACHABLE, f"{peer.ae_title} {told} {calling}")
    try:
        yield association
    finally:
        association.release()


def _knock(host: str, peer: PeerSettings, within_s: float) -> None:
    """Whether anybody listens at all: pynetdicom leaves the socket of a refused connection open, and says nothing."""
    try:
        socket.create_connection((host, peer.port), within_s).close()
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise ServiceError(
            ErrorCode.PEER_UNREACHABLE, f"{peer.ae_title} at {host}:{peer.port} does not listen: {reason}"
        ) from error
