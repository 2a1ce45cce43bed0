"""Device files: upload, list, read back."""

from dataclasses import asdict
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response
from pydantic import BaseModel

from service.audit import record_audit
from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.auth.session import Session
from service.devices import store
from service.devices.store import DeviceKind
from service.errors import ErrorCode
from service.openapi import answers_with, may_fail_with
from service.parts import Parts, parts_of

router = APIRouter(tags=["devices"])
Reader = Annotated[Session, Depends(require(Permission.READ))]
PartsOfRoom = Annotated[Parts, Depends(parts_of)]
_TOML_BODY: dict[str, Any] = {"requestBody": {"required": True, "content": {"application/toml": {"schema": {}}}}}


class DeviceView(BaseModel):
    """A device file without its bytes."""

    id: str
    kind: DeviceKind
    name: str
    version: str
    sha256: str
    expires: str | None
    uploaded_by: str
    position: int
    uploaded_at: str


async def raw_body(request: Request) -> bytes:
    """The request's body to the byte: the hash of a device file is over what its maker wrote."""
    return await request.body()


@router.post(
    "/devices/{kind}",
    status_code=201,
    openapi_extra=_TOML_BODY | may_fail_with(ErrorCode.DEVICE_REFUSED, ErrorCode.DEVICE_VERSION_TAKEN),
)
def upload_device(
    kind: DeviceKind,
    content: Annotated[bytes, Depends(raw_body)],
    session: Annotated[Session, Depends(require(Permission.UPLOAD_DEVICE))],
    parts: PartsOfRoom,
) -> DeviceView:
    """Store a device file (TOML) that its reader finds plausible; the same bytes again are the same device."""
    with parts.database.write() as connection:
        device = store.add_device(connection, kind, content, session.user_id)
        record_audit(connection, "device_uploaded", session.user_id, {"device": device.id, "sha256": device.sha256})
    return DeviceView(**asdict(device))


@router.get("/devices")
def list_all_devices(_: Reader, parts: PartsOfRoom) -> list[DeviceView]:
    """Every device file, newest first; the newest of each kind is used for the next case."""
    with parts.database.read() as connection:
        return [DeviceView(**asdict(device)) for device in store.list_devices(connection)]


@router.get(
    "/devices/{device_id}/original",
    response_class=Response,
    responses=answers_with("application/toml"),
    openapi_extra=may_fail_with(ErrorCode.DEVICE_UNKNOWN),
)
def read_device_file(device_id: str, _: Reader, parts: PartsOfRoom) -> Response:
    """The bytes as uploaded."""
    with parts.database.read() as connection:
        return Response(store.device_bytes(connection, device_id), media_type="application/toml")
