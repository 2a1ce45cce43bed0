"""The interface description, with every error of every operation."""

from collections import defaultdict
from collections.abc import Callable, Iterable
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from service.errors import ErrorCode, answer_for
from service.problem_json import MEDIA_TYPE, Problem

_KEY = "x-error-codes"
# What a session's token is sent as; a route that needs none says so itself, by NO_SESSION.
_SESSION = {
    "bearer": {"type": "http", "scheme": "bearer", "description": "the token that POST /api/session answers with"},
    "cookie": {"type": "apiKey", "in": "cookie", "name": "coaxial_session"},
}
NO_SESSION: dict[str, Any] = {"security": []}
_METHODS = frozenset({"get", "post", "put", "patch", "delete"})

# What any request can meet, whatever it asks.
_ALWAYS = (
    ErrorCode.MALFORMED_REQUEST,
    ErrorCode.BODY_TOO_LARGE,
    ErrorCode.REQUEST_REFUSED,
    ErrorCode.NOT_SIGNED_IN,
    ErrorCode.SESSION_EXPIRED,
    ErrorCode.SESSION_LOCKED,
    ErrorCode.PERMISSION_MISSING,
    ErrorCode.ORIGIN_REFUSED,
    ErrorCode.INTERNAL_FAULT,
    ErrorCode.DATABASE_FAULT,
    ErrorCode.DATABASE_BUSY,
    ErrorCode.DISK_FULL,
)


def may_fail_with(*codes: str) -> dict[str, Any]:
    """For a route's `openapi_extra`: the error codes that it has beside those that every route has."""
    return {_KEY: [str(code) for code in codes]}


def answers_with(*media_types: str) -> dict[int | str, dict[str, Any]]:
    """For a route's `responses`: that it answers with a file or a stream of one of these kinds, and not with JSON."""
    return {200: {"content": {media_type: {} for media_type in media_types}}}


def described_by(app: FastAPI) -> Callable[[], dict[str, Any]]:
    """A replacement for `app.openapi` that lists every error."""

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            schema = get_openapi(title=app.title, version=app.version, description=app.description, routes=app.routes)
            app.openapi_schema = _with_errors(schema)
        return app.openapi_schema

    return openapi


def _with_errors(schema: dict[str, Any]) -> dict[str, Any]:
    schemas = schema.setdefault("components", {}).setdefault("schemas", {})
    schemas["Problem"] = Problem.model_json_schema(ref_template="#/components/schemas/{model}")
    schema["components"]["securitySchemes"] = _SESSION
    schema["security"] = [{name: []} for name in _SESSION]
    schemas.pop("HTTPValidationError", None)
    schemas.pop("ValidationError", None)
    for path in schema["paths"].values():
        for method in _METHODS & path.keys():
            codes = [*_ALWAYS, *path[method].get(_KEY, ())]
            path[method]["responses"] |= _responses(codes)
    return schema


def _responses(codes: Iterable[str]) -> dict[str, Any]:
    by_status: dict[int, list[str]] = defaultdict(list)
    for code in codes:
        by_status[answer_for(code).status].append(str(code))
    content = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
    return {
        str(status): {"description": ", ".join(dict.fromkeys(found)), "content": content}
        for status, found in sorted(by_status.items())
    }
