"""Serves the tablet's files: nothing but what was read at start, under a policy that lets nothing else in or out."""

from fastapi import APIRouter, Request, Response

from service.web.assets import assets

router = APIRouter(include_in_schema=False)

# Everything comes from and goes to the service itself; `data:` is the picked point as the server drew it back,
# and the icons.
POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' data:",
        "connect-src 'self'",
        "manifest-src 'self'",
        "frame-ancestors 'none'",
        "base-uri 'none'",
        "form-action 'none'",
        "require-trusted-types-for 'script'",
    )
)
_HEADERS = {
    "Content-Security-Policy": POLICY,
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=()",
    "Cache-Control": "no-cache",  # kept, but asked for anew: a tablet must not run yesterday's client
}


async def read_asset(request: Request) -> Response:
    """A file of the client, or only that it has not changed."""
    asset = assets()[request.url.path]
    headers = _HEADERS | {"ETag": asset.etag}
    if request.headers.get("if-none-match") == asset.etag:
        return Response(status_code=304, headers=headers)
    return Response(asset.content, headers=headers, media_type=asset.media_type)


# A route for each file, not one for any name: every other address stays unknown, with whatever method it is asked for.
for _path in assets():
    router.add_api_route(_path, read_asset)
