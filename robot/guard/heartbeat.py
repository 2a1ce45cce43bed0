"""Challenge heartbeats: silence is judged by the age of the challenge that came back (H16, H36)."""

import secrets
from collections import OrderedDict

from robot.guard.messages import Heartbeat

SILENCE_S = 0.2  # H16
_REMEMBERED = 512  # challenges: at 40 a second nearly 13 s, far beyond any age that still counts


class HeartbeatMonitor:
    """Judges one permit's hold at a time; pure, the clock is passed in.

    A heartbeat counts if its number is the newest of its permit and its challenge was issued here. Its age is the time
    since that challenge was issued, so that traffic which was held up on its way counts for as old as it is.
    """

    def __init__(self) -> None:
        self._issued: OrderedDict[str, float] = OrderedDict()
        self._retired: set[str] = set()
        self._permit_id: str | None = None
        self._number = -1
        self._echoed_at_s: float | None = None
        self._held = False
        self._released = False

    @property
    def permit_id(self) -> str | None:
        """Permit of the newest heartbeat."""
        return self._permit_id

    @property
    def held(self) -> bool:
        """Whether the newest heartbeat says held, and none of this permit ever said otherwise."""
        return self._held and not self._released

    def issue(self, now_s: float) -> str:
        """A new challenge, which nobody can know before."""
        challenge = secrets.token_hex(8)
        self._issued[challenge] = now_s
        if len(self._issued) > _REMEMBERED:
            self._issued.popitem(last=False)
        return challenge

    def receive(self, heartbeat: Heartbeat) -> bool:
        """Take a heartbeat in; True if it is a new sign of life that may feed the watchdog (H20)."""
        if heartbeat.permit_id in self._retired:
            return False
        if heartbeat.permit_id != self._permit_id:
            self._follow(heartbeat.permit_id)
        if not heartbeat.held:
            self._released = True  # whatever its number or age: letting go never comes too late or too early
        issued_at_s = self._issued.get(heartbeat.challenge)
        if issued_at_s is None or heartbeat.number <= self._number:
            return False
        self._number = heartbeat.number
        self._held = heartbeat.held
        newer = self._echoed_at_s is None or issued_at_s > self._echoed_at_s
        self._echoed_at_s = issued_at_s if newer else self._echoed_at_s
        return self.held

    def retire(self) -> None:
        """Whatever is held now is never heard again: a stop or a person came between, and a new permit is needed."""
        self._follow(None)

    def age_s(self, now_s: float) -> float | None:
        """Age of the newest challenge that came back under this permit; None before the first."""
        return None if self._echoed_at_s is None else now_s - self._echoed_at_s

    def is_live(self, permit_id: str, now_s: float) -> bool:
        """Whether a permit is held, by an echo younger than the limit."""
        age_s = self.age_s(now_s)
        return permit_id == self._permit_id and self.held and age_s is not None and age_s <= SILENCE_S

    def is_let_go(self, permit_id: str) -> bool:
        """Whether the hand under this permit opened: a hold that another permit's took the place of is lost instead."""
        return permit_id == self._permit_id and not self.held

    def _follow(self, permit_id: str | None) -> None:
        """Turn to a new permit, or to none; the old one's late heartbeats are never heard again."""
        if self._permit_id is not None:
            self._retired.add(self._permit_id)
        self._permit_id = permit_id
        self._number = -1
        self._echoed_at_s = None
        self._held = False
        self._released = False
