"""The permission table covers every route, and every role meets over HTTP exactly what the table says."""

import json

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from service.app import ROUTERS
from service.auth.dependencies import any_session, stop_caller
from service.auth.permissions import ROLE_PERMISSIONS, Permission, Role
from tests.service.conftest import PASSWORD

# Who signs in has no session yet; health tells nothing.
_OPEN = {"POST /session", "GET /health/live", "GET /health/ready"}
# One's own session, whatever it is still good for.
_OWN_SESSION = {"GET /session", "DELETE /session", "POST /session/lock", "POST /session/unlock"}


def _calls(dependant) -> list:
    return [dependant.call, *(call for inner in dependant.dependencies for call in _calls(inner))]


def _routes() -> dict[str, list]:
    """Everything that the routes of each method and path depend on."""
    routes = {}
    for router in ROUTERS:
        for route in router.routes:
            for method in getattr(route, "methods", None) or {"WEBSOCKET"}:
                routes[f"{method} {route.path}"] = _calls(route.dependant)
    return routes


_PERMISSIONS = {
    name: {call.permission for call in calls if hasattr(call, "permission")} for name, calls in _routes().items()
}


@pytest.mark.parametrize("name", sorted(_routes()))
def test_every_route_asks_for_one_permission_or_is_listed_as_an_exception(name):
    calls = _routes()[name]
    if name in _OPEN:
        assert any_session not in calls
    elif name in _OWN_SESSION:
        assert any_session in calls
    elif stop_caller in calls:
        assert name.endswith(("/stop", "/emergency-access")), "only what stops may do without the database"
    else:
        assert len(_PERMISSIONS[name]) == 1, "Depends(require(Permission...)) is missing, or two are given"


def test_no_exception_is_left_over():
    assert _routes().keys() >= _OPEN | _OWN_SESSION


def test_every_role_has_a_row_and_may_read_and_stop():
    assert ROLE_PERMISSIONS.keys() == set(Role)
    assert all({Permission.READ, Permission.STOP} <= permissions for permissions in ROLE_PERMISSIONS.values())


def test_only_a_surgeon_approves_and_moves():
    for permission in (Permission.APPROVE, Permission.MOVE, Permission.TARGET, Permission.TAKE_LEASE):
        assert [role for role in Role if permission in ROLE_PERMISSIONS[role]] == [Role.SURGEON]


def test_who_may_not_move_the_arm_is_refused_and_that_is_in_the_record(running):
    with running.client(Role.OPERATOR) as operator, running.client(Role.AUDITOR) as auditor:
        assert operator.post("/cases/some-case/lease-taken", json={"reason": "why not"}).status_code == 403
        newest = auditor.get("/audit", params={"action": "permission_refused"}).text
    for told in ("take_lease", "operator", "some-case", "/cases/{case_id}/lease-taken"):
        assert told in newest


def _requests() -> list[tuple[str, str]]:
    return [(name.split()[0], name.split()[1]) for name in sorted(_routes()) if not name.startswith("WEBSOCKET")]


@pytest.mark.hazard("H27")
@pytest.mark.parametrize(("method", "path"), _requests(), ids=lambda value: value)
def test_a_stranger_is_refused_at_every_route(running, method, path):
    if f"{method} {path}" in _OPEN:
        return
    with running.client(None) as client:
        response = client.request(method, path.replace("{kind}", "guide").replace("{case_id}", "x"))
    assert response.status_code == 401
    assert response.json()["code"] == "not_signed_in"


@pytest.mark.hazard("H27")
@pytest.mark.parametrize(("method", "path"), _requests(), ids=lambda value: value)
def test_a_role_without_the_permission_is_refused_and_one_with_it_is_not(running, method, path):
    permissions = _PERMISSIONS[f"{method} {path}"]
    if not permissions:
        return
    for role in Role:
        with running.client(role) as client:
            response = client.request(method, path.replace("{kind}", "guide").replace("{case_id}", "x"))
        refused = response.headers["content-type"] == "application/problem+json" and response.json()["code"]
        assert (refused == "permission_missing") is not (permissions <= ROLE_PERMISSIONS[role]), role


def _refusal_of_hold(running, token: str | None) -> str:
    """The code with which a WebSocket's handshake is refused."""
    url = f"{running.url.replace('http', 'ws', 1)}/api/cases/some-case/hold?permit=p"
    headers = {"Authorization": f"Bearer {token}"} if token else {}
    with pytest.raises(InvalidStatus) as caught, connect(url, additional_headers=headers):
        pass
    return json.loads(caught.value.response.body)["code"]


@pytest.mark.hazard("H27")
@pytest.mark.parametrize("role", Role)
def test_the_button_is_held_by_nobody_but_who_may_move(running, role):
    may_move = Permission.MOVE in ROLE_PERMISSIONS[role]
    assert (_refusal_of_hold(running, running.tokens[role]) == "permission_missing") is not may_move


@pytest.mark.hazard("H27")
def test_the_button_is_held_by_no_stranger_and_with_no_session_that_is_over(running):
    with running.client(None) as client:
        token = client.post("/session", json={"name": "surgeon", "password": PASSWORD}).json()["token"]
        assert client.delete("/session").status_code == 204
    assert _refusal_of_hold(running, None) == _refusal_of_hold(running, token) == "not_signed_in"
