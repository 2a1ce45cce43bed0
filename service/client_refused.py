"""A typed no of the service, as the client raises it."""

import json
from typing import Any, Self


class Refused(Exception):  # noqa: N818  it is an answer, not a fault
    """What was refused and why; `problem` is the whole answer."""

    def __init__(self, status: int, problem: dict[str, Any]) -> None:
        super().__init__(f"{status} {problem.get('code')}: {problem.get('detail')}")
        self.status = status
        self.code = str(problem.get("code"))
        self.detail = str(problem.get("detail"))
        self.what_to_do = str(problem.get("what_to_do"))
        self.measured = problem.get("measured")
        self.limit = problem.get("limit")
        self.leads_onwards: list[str] = list(problem.get("leads_onwards", ()))
        self.verdicts: list[dict[str, Any]] = list(problem.get("verdicts", ()))
        self.problem = problem

    @classmethod
    def from_body(cls, status: int, body: bytes | bytearray) -> Self:
        """From the bytes of an answer, whether it is a problem or something in between said no."""
        try:
            problem = json.loads(body)
        except ValueError:
            problem = None
        return cls(status, problem if isinstance(problem, dict) else {"detail": body.decode(errors="replace")})
