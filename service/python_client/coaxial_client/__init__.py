"""The public Python client of Coaxial: what a scripted user needs of a room's service, and nothing else.

    with Coaxial("http://127.0.0.1:8700") as room:
        room.sign_in("surgeon", "password")
        print(room.status()["open_case"])

It speaks the service's HTTP and WebSocket interface and imports nothing of Coaxial's other packages. What the service
refuses is raised as `Refused`; where nothing comes back, `NoAnswer` is. No request is ever sent a second time: after
`NoAnswer` the case's status says what became of it, and a motion is only ever planned and approved anew.
"""

from coaxial_client.answers import NoAnswer, Refused
from coaxial_client.case import Case
from coaxial_client.hold import Hold, HoldEnded
from coaxial_client.room import Coaxial
from coaxial_client.transport import Json

__all__ = ["Case", "Coaxial", "Hold", "HoldEnded", "Json", "NoAnswer", "Refused"]
