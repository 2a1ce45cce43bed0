"""What a verification found, and where."""

from collections import Counter
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that is not as it was recorded."""

    where: str
    what: str


@dataclass(slots=True)
class Verification:
    """The findings so far, and how much was looked at."""

    findings: list[Finding] = field(default_factory=list)
    entries: int = 0
    vouched: Counter[str] = field(default_factory=Counter)  # rows by table that an entry vouches for
    closings: list[int] = field(default_factory=list)  # entries that close a case
    checkpoints: int = 0
    anchored: int = 0  # the entry that the anchor names; what is newer is not anchored yet

    @property
    def rows(self) -> int:
        """How many rows were compared."""
        return self.vouched.total()

    def find(self, where: str, what: str) -> None:
        """Add a finding."""
        self.findings.append(Finding(where, what))

    def add(self, part: "Verification") -> None:
        """Add what was found in a part."""
        self.findings += part.findings
        self.entries += part.entries
        self.vouched += part.vouched
        self.closings += part.closings
