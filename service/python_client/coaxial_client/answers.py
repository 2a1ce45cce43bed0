"""What is raised instead of an answer: a typed no of the service, or that nothing came back."""

import json
from typing import Any, Self


class NoAnswer(ConnectionError):  # noqa: N818  it says what happened
    """Nothing came back: no connection, a broken one, or none within the time limit.

    Whether a command was carried out is not known then, and the client sends none again by itself.
    """


class Refused(Exception):  # noqa: N818  it is an answer, not a fault
    """What was refused and why.

    Attributes
    ----------
    status : int
        The HTTP status.
    code : str
        The stable code, as listed in docs/error-codes.md; "None" if something between client and service said no.
    detail, what_to_do : str
        For people.
    measured, limit : float, str, bool or None
        What was measured against which limit, where the refusal is about a quantity.
    leads_onwards : list of str
        The triggers that are possible instead.
    verdicts : list of dict
        Every interlock that was asked, with `code`, `hazard`, `passed`, `measured`, `limit`, `unit`.
    problem : dict
        The whole answer (application/problem+json).
    """

    def __init__(self, status: int, problem: dict[str, Any]) -> None:
        super().__init__(f"{status} {problem.get('code')}: {problem.get('detail')}")
        self.status = status
        self.code = str(problem.get("code"))
        self.detail = str(problem.get("detail"))
        self.what_to_do = str(problem.get("what_to_do"))
        self.measured: float | str | bool | None = problem.get("measured")
        self.limit: float | str | bool | None = problem.get("limit")
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
