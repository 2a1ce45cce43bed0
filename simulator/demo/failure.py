"""Why a run ended early, in one line that says what to look at."""

from typing import Any

import httpx

from coaxial_client import HoldEnded, NoAnswer, Refused


class DemoFailed(Exception):  # noqa: N818  it names what happened, as the line that is printed does
    """Something did not happen as it should; `code` is stable, the text is for people."""

    def __init__(self, code: str, text: str) -> None:
        super().__init__(f"{code}: {text}")
        self.code = code


class NothingStartedError(DemoFailed):
    """It ended before any process was started, so that there is no log of this run."""


class SeenToMoveError(DemoFailed):
    """An image after a motion shows that C-arm, base or patient moved: what was registered is void."""


def failed_motion(kind: str, ended: HoldEnded) -> DemoFailed:
    """A motion that did not arrive."""
    if ended.problem is not None:
        return DemoFailed(str(ended.problem["code"]), f"{kind}: {ended.problem['detail']}")
    away = "" if ended.distance_mm is None else f", {ended.distance_mm:.2f} mm before the goal"
    return DemoFailed(ended.cause, f"the {kind} motion ended in {ended.state or 'an unknown state'}{away}")


def failed_verdicts(verdicts: list[dict[str, Any]]) -> str:
    """Every interlock that refused, with what it measured."""
    failed = [verdict for verdict in verdicts if not verdict["passed"]]
    return "; ".join(f"{one['code']} ({one['hazard']}): {one['message']}, {measured(one)}" for one in failed)


def measured(verdict: dict[str, Any]) -> str:
    """The measured value beside its limit."""
    return f"measured {_short(verdict['measured'])}, limit {_short(verdict['limit'])}"


def explain(error: DemoFailed | Refused | NoAnswer | httpx.HTTPError | OSError) -> str:
    """One line: code, text, measured value and limit, what to do."""
    match error:
        case Refused():
            reasons = failed_verdicts(error.verdicts)
            return f"{error.code}: {reasons or error.detail}. {error.what_to_do}".rstrip(".")
        case NoAnswer():
            return f"no_answer: {error}"
        case httpx.HTTPError():
            return f"no_answer: {type(error).__name__} {error}"
        case TimeoutError():
            return f"too_late: {error}"
        case OSError():
            return f"system_refused: {error}"
        case DemoFailed():
            return str(error)


def _short(value: object) -> object:
    return f"{value:.4g}" if isinstance(value, float) else value
