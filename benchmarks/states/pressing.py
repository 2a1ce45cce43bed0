"""The held button of a sequence: over the service's own WebSocket."""

import json
from typing import Any

from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from benchmarks.states.play import Difference, Play

Json = dict[str, Any]


def press(play: Play, person: str, permit: str, token: int | None) -> Json | None:
    """Press, and hold on; the problem of a refusal, None once the motion is under way."""
    play.requests += 1
    control = "" if token is None else f"&control_token={token}"
    url = f"ws://127.0.0.1:{play.room.port}/api/cases/{play.case_id}/hold?permit={permit}{control}"
    bearer = {"Authorization": f"Bearer {play.room.tokens[person]}"}
    try:
        socket = play.button.enter_context(connect(url, additional_headers=bearer, proxy=None))
    except InvalidStatus as refused:
        problem: Json = json.loads(refused.response.body)
        return problem
    socket.send(json.dumps({"number": 1, "challenge": "c1", "held": True}))
    ended: Json = {}
    if not play.room.wait(lambda: play.room.guard.begun.acquire(blocking=False) or _is_over(socket, ended)):
        raise Difference("neither did the motion begin nor was it refused")
    if not ended:
        return None
    play.button.close()
    play.room.guard.let_go()
    return dict(ended["problem"])


def _is_over(socket: ClientConnection, ended: Json) -> bool:
    """Whether the service has said that a hold is over; what it said goes into `ended`."""
    try:
        message = json.loads(socket.recv(timeout=0.0))
    except TimeoutError:
        return False
    if message["type"] == "ended":
        ended.update(message)
    return bool(ended)
