"""Errors as application/problem+json (RFC 9457); an answer never holds an exception's text or a stack."""

import secrets
from typing import Any

import structlog
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError, ValidationException, WebSocketRequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel
from starlette.exceptions import HTTPException

from service.errors import ErrorCode, ServiceError, answer_for, code_for_status

_log = structlog.get_logger(__name__)
MEDIA_TYPE = "application/problem+json"


class Problem(BaseModel):
    """The body of every error."""

    type: str
    title: str
    status: int
    code: str
    detail: str
    what_to_do: str
    measured: float | str | bool | None = None
    limit: float | str | bool | None = None
    leads_onwards: list[str] = []
    verdicts: list[dict[str, Any]] = []
    fields: list[dict[str, str]] = []
    incident: str | None = None


def problem_of(error: ServiceError, **more: Any) -> Problem:
    """The body for one error."""
    answer = answer_for(error.code)
    return Problem(
        type=f"urn:coaxial:error:{error.code}",
        title=error.code.replace("_", " "),
        status=answer.status,
        code=error.code,
        detail=error.message,
        what_to_do=answer.what_to_do,
        measured=error.measured,
        limit=error.limit,
        leads_onwards=list(error.leads_onwards),
        verdicts=[dict(verdict) for verdict in error.verdicts],
        **more,
    )


def answer_error(error: ServiceError, headers: dict[str, str] | None = None, **more: Any) -> JSONResponse:
    """The whole answer for one error."""
    problem = problem_of(error, **more)
    return JSONResponse(problem.model_dump(mode="json"), problem.status, headers, MEDIA_TYPE)


def answer_malformed(error: ValidationException) -> JSONResponse:
    """The whole answer for a request whose fields are not what they must be, each named."""
    fields = [{"field": ".".join(map(str, one["loc"])), "problem": one["msg"]} for one in error.errors()]
    first = f"{fields[0]['field']}: {fields[0]['problem']}" if fields else "the request cannot be read"
    return answer_error(ServiceError(ErrorCode.MALFORMED_REQUEST, first), fields=fields)


def add_problem_handlers(app: FastAPI) -> None:
    """Answer every error of `app` as problem+json."""
    app.add_exception_handler(ServiceError, _service_error)
    app.add_exception_handler(RequestValidationError, _malformed)
    app.add_exception_handler(WebSocketRequestValidationError, _malformed)
    app.add_exception_handler(HTTPException, _framework_error)
    app.add_exception_handler(Exception, _fault)


async def _service_error(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, ServiceError)  # noqa: S101  registered for this type only
    _log.warning("request_refused", code=error.code, method=_method(request), route=_route(request))
    return answer_error(error)


async def _malformed(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, ValidationException)  # noqa: S101  registered for its kinds only
    _log.warning("request_refused", code=ErrorCode.MALFORMED_REQUEST, method=_method(request), route=_route(request))
    return answer_malformed(error)


async def _framework_error(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)  # noqa: S101  registered for this type only
    if isinstance(error.__cause__, ServiceError):  # raised while the framework read the body, and wrapped by it
        return await _service_error(request, error.__cause__)
    code = code_for_status(error.status_code)
    _log.warning("request_refused", code=code, method=_method(request), route=_route(request))
    return answer_error(ServiceError(code, f"{_method(request)} {request.url.path}"), dict(error.headers or {}))


async def _fault(request: Request, error: Exception) -> JSONResponse:
    incident = secrets.token_hex(4)
    _log.error("request_failed", incident=incident, method=_method(request), route=_route(request), exc_info=error)
    return answer_error(ServiceError(ErrorCode.INTERNAL_FAULT, "the service failed at this request"), incident=incident)


def _method(request: Request) -> str:
    """The method; a WebSocket, whose handshake may be refused too, has none."""
    return str(request.scope.get("method", "WEBSOCKET"))


def _route(request: Request) -> str:
    """The route's pattern, not the address: an address could hold what a person typed."""
    return getattr(request.scope.get("route"), "path", "none")
