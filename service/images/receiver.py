"""The DICOM receiver: answers success only after the bytes are committed; decoding comes later, elsewhere."""

import secrets
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import structlog
from pydicom import Dataset
from pynetdicom import AE, AllStoragePresentationContexts, evt
from pynetdicom.sop_class import Verification
from sqlalchemy.exc import SQLAlchemyError

from service.audit import record_audit
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.images import store
from service.images.arrivals import ImageArrivals
from service.images.dicom_header import read_header
from service.images.dicom_port import MOST_CONNECTIONS, PDU_BYTES, DicomPort
from service.settings import DicomSettings

_log = structlog.get_logger(__name__)

# DICOM PS3.4, C-STORE: success; out of resources; cannot understand.
_SUCCESS, _OUT_OF_RESOURCES, _CANNOT_UNDERSTAND = 0x0000, 0xA700, 0xC000
# Of what is not stored; a sender may try again where resources were wanting.
_STATUS: dict[str, int] = {ErrorCode.IMAGE_UID_TAKEN: _CANNOT_UNDERSTAND}
# Room for the headers of the protocol's own units around a largest image.
_PROTOCOL_OVERHEAD = 1.05
_TIMEOUT_S = 30.0
_LOOKS_EVERY_S = 0.1  # how late the port notices that it is to close
# An empty list lets everybody in; nobody can know this title, so that nobody comes in where no caller is named.
_NOBODY = secrets.token_hex(8)
_TO_NAME_CALLERS = 'dicom.accepted_callers = ["CARM"] in the settings, or COAXIAL_DICOM__ACCEPTED_CALLERS=\'["CARM"]\''
# Explicit and implicit little endian, explicit big endian, deflated.
_UNCOMPRESSED = tuple(f"1.2.840.10008.1.2{one}" for one in (".1", "", ".2", ".1.99"))
# RLE; JPEG baseline, extended, lossless (two), LS (two), 2000 (two): what the image worker can decode.
_COMPRESSED = (
    "1.2.840.10008.1.2.5",
    *(f"1.2.840.10008.1.2.4.{one}" for one in (50, 51, 57, 70, 80, 81, 90, 91)),
)


class DicomReceiver:
    """A C-STORE and C-ECHO provider in threads of its own."""

    def __init__(
        self, settings: DicomSettings, database: Database, arrivals: ImageArrivals, check_room: Callable[[], None]
    ) -> None:
        self._settings = settings
        self._database = database
        self._arrivals = arrivals
        self._check_room = check_room  # ServiceError DISK_FULL where there is too little for an image

    @contextmanager
    def listening(self) -> Iterator[int]:
        """Receive until the end of the block; yields the port, which matters where the settings say 0."""
        entity = AE(ae_title=self._settings.ae_title)
        for context in AllStoragePresentationContexts:
            entity.add_supported_context(context.abstract_syntax, [*_UNCOMPRESSED, *_COMPRESSED])
        entity.add_supported_context(Verification)
        entity.require_calling_aet = list(self._settings.accepted_callers) or [_NOBODY]
        entity.maximum_pdu_size = PDU_BYTES
        entity.maximum_associations = MOST_CONNECTIONS
        entity.acse_timeout = entity.dimse_timeout = entity.network_timeout = _TIMEOUT_S
        server = self._started(entity)
        if not self._settings.accepted_callers:
            _log.warning("dicom_accepts_nobody", what_to_do=f"name the C-arm's AE title: {_TO_NAME_CALLERS}")
        try:
            yield int(server.socket.getsockname()[1])
        finally:
            server.shutdown()

    def _started(self, entity: AE) -> DicomPort:
        address = (self._settings.host, self._settings.port)
        handlers = [
            (evt.EVT_C_STORE, self._on_store),
            (evt.EVT_DATA_RECV, self._on_data),
            (evt.EVT_REJECTED, self._on_rejected),
            (evt.EVT_ABORTED, self._on_aborted),
        ]
        try:
            server: DicomPort = entity.make_server(address, evt_handlers=handlers, server_class=DicomPort)
        except OSError as error:
            message = f"cannot listen for DICOM on {address[0]}:{address[1]} ({error.strerror})"
            raise ServiceError(ErrorCode.SETTINGS_REFUSED, message) from error
        listen = partial(server.serve_forever, poll_interval=_LOOKS_EVERY_S)
        threading.Thread(target=listen, name="dicom-port", daemon=True).start()
        return server

    def _on_data(self, event: Any) -> None:
        """Count bytes of the message under way, and hang up before memory is full (H31)."""
        received = getattr(event.assoc, "coaxial_bytes", 0) + len(event.data)
        event.assoc.coaxial_bytes = received
        if received > self._settings.max_image_bytes * _PROTOCOL_OVERHEAD and not event.assoc.is_aborted:
            limit = self._settings.max_image_bytes
            _log.warning("image_refused", code=ErrorCode.IMAGE_BYTES_TOO_LARGE, measured=received, limit=limit)
            event.assoc.abort()

    def _on_rejected(self, event: Any) -> None:
        caller = event.assoc.requestor
        _log.warning(
            "dicom_caller_refused", calling_ae=caller.ae_title, address=caller.address, what_to_do=_TO_NAME_CALLERS
        )

    def _on_aborted(self, event: Any) -> None:
        """Whoever looks for an image that did not arrive finds here that it was never sent whole."""
        caller, received = event.assoc.requestor, getattr(event.assoc, "coaxial_bytes", 0)
        _log.warning(
            "dicom_broken_off", calling_ae=caller.ae_title, address=caller.address, bytes_since_last_image=received
        )

    def _on_store(self, event: Any) -> Dataset:
        event.assoc.coaxial_bytes = 0
        caller = {"calling_ae": event.assoc.requestor.ae_title, "address": event.assoc.requestor.address}
        try:
            image = self.receive(event.encoded_dataset(), caller)
        except ServiceError as error:
            _log.error("image_not_stored", code=error.code)
            return _answer(_STATUS.get(error.code, _OUT_OF_RESOURCES), error.code)
        except SQLAlchemyError:
            _log.exception("image_not_stored", code=ErrorCode.DATABASE_FAULT)
            return _answer(_OUT_OF_RESOURCES, ErrorCode.DATABASE_FAULT)
        return _answer(_CANNOT_UNDERSTAND, image.problem["code"]) if image.problem else _answer(_SUCCESS, "")

    def receive(self, content: bytes, source: dict[str, Any]) -> store.StoredImage:
        """Commit the bytes, then tell of them; what is sent again is the image that it was.

        ServiceError where they could not be committed, IMAGE_UID_TAKEN where their UID came with other bytes.
        """
        self._check_room()  # H24: what is left is for the record of the procedure
        header, problem = read_header(content, self._settings)
        try:
            with self._database.write(bulky=True) as connection:
                again = store.image_sent_again(connection, content, header)
                image = again or store.add_image(connection, content, header, problem, source)
                if again is not None:
                    record_audit(connection, "image_sent_again", None, {"image_id": again.id, **source})
        except ServiceError as error:
            self._record_refused(error, source)
            raise
        if again is None:
            self._tell(image)
        return image

    def _record_refused(self, error: ServiceError, source: dict[str, Any]) -> None:
        """An image that claims to be another; a database that cannot be written is not asked again."""
        if error.code == ErrorCode.IMAGE_UID_TAKEN:
            with self._database.write() as connection:
                record_audit(
                    connection, "image_refused", None, {"code": error.code, "message": error.message, **source}
                )

    def _tell(self, image: store.StoredImage) -> None:
        _log.info("image_stored", image_id=image.id, duplicate=image.duplicate_of is not None)
        if image.problem is not None:
            _log.warning("image_refused", image_id=image.id, code=image.problem["code"])
        self._arrivals.announce(image.id)


def _answer(status: int, comment: str) -> Dataset:
    answer = Dataset()
    answer.Status = status
    if comment:
        answer.ErrorComment = comment
    return answer
