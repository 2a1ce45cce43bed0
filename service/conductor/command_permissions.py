"""Which permission each command asks for, read off the routes, so that the status can tell before it is asked."""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Depends
from fastapi.routing import APIRoute
from starlette.requests import HTTPConnection

from service.auth.permissions import Permission
from workflow.triggers import Trigger

_OF_A_CASE = "/cases/{case_id}/"


def command_permissions(routers: Iterable[APIRouter]) -> dict[Trigger, Permission]:
    """The permission of every command whose route is named as its trigger; those that anybody may send are left out."""
    routes = (route for router in routers for route in router.routes if isinstance(route, APIRoute))
    named = ((_trigger_of(route), route) for route in routes)
    return {
        trigger: permission
        for trigger, route in named
        if trigger is not None
        for permission in _permissions(route.dependant)
    }


def _trigger_of(route: APIRoute) -> Trigger | None:
    name = route.path.removeprefix(_OF_A_CASE).replace("-", "_")
    return Trigger(name) if name in tuple(Trigger) else None


def _permissions(dependant: Any) -> Iterable[Permission]:
    if hasattr(dependant.call, "permission"):
        yield dependant.call.permission
    for inner in dependant.dependencies:
        yield from _permissions(inner)


async def permissions_of(connection: HTTPConnection) -> Mapping[Trigger, Permission]:
    """The permissions of the service that this request came to."""
    permissions: Mapping[Trigger, Permission] = connection.app.state.command_permissions
    return permissions


CommandPermissions = Annotated[Mapping[Trigger, Permission], Depends(permissions_of)]
