"""The public Python client of Coaxial: what a scripted user needs of a room's service, and nothing else.

    >>> with Coaxial(url) as room:
    ...     _ = room.sign_in("surgeon", password)
    ...     room.status()["open_case"] is None
    True

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
