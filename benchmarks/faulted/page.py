"""The page of the scenes with one thing wrong each, made from the published results."""

from collections.abc import Iterable, Mapping, Sequence

from benchmarks.evidence.published import State, bounds_95
from benchmarks.faulted.trials import ITEMS, PLANNED, REGISTERED
from simulator.carm.faulted import Fault

_HEAD = """# Scenes with one thing wrong

Made by `make faulted` from its [results](faulted.json); written by no hand. Each scene is rendered, registered and
targeted with the reference guide's file; it is wrong where it is accepted and the aim is off by more than 0.5 deg or
1.0 mm, or the image was flipped. Shares are with 95 % confidence (Clopper and Pearson). The same fault and seed give
the same scene.

A result counts for the code that it was made with, and for no other. The results go with the code: a run adds to them
what it did and runs only what they lack, so the scenes may be gathered over several days.

"""
_TABLE = """
| fault | scenes | wrong | at most | registered | between | worst | seeds | refused |
|---|---:|---:|---:|---:|---:|---:|---|---|
"""
_EARLIER = """
## Earlier states of the code

Counted in no row above: one of the files has changed since.

| code | commits | scenes | wrong | registered where nothing is wrong |
|---|---|---:|---:|---:|
"""


def page(states: Mapping[str, Sequence[State]]) -> str:
    """Markdown: what was asked for in words, a row for each fault, what was done of earlier code."""
    today = {fault: states[fault][-1] for fault in ITEMS}
    rows = [_row(fault, state) for fault, state in today.items() if state.done]
    earlier: dict[str, dict[str, State]] = {}
    for fault, listed in states.items():
        for state in listed[:-1]:
            earlier.setdefault(state.code, {})[fault] = state
    history = "".join(f"{_of_code(code, by_fault)}\n" for code, by_fault in earlier.items())
    return (
        _HEAD
        + "\n".join(_verdict(today))
        + "\n"
        + ("\n".join((_TABLE.rstrip("\n"), *rows, "")) if rows else "")
        + (f"{_EARLIER}{history}" if history else "")
    )


def _verdict(today: Mapping[Fault, State]) -> Iterable[str]:
    """What was asked for, in words; then every wrong acceptance."""
    done, bad = (sum(getattr(state, what) for state in today.values()) for what in ("done", "bad"))
    nominal = today[Fault.NOTHING]
    most = 100.0 * bounds_95(bad, done)[1]
    yield f"Code `{nominal.code}`: {done:,} of {PLANNED:,} scenes.\n"
    yield f"- Wrong: {bad:,}, at most {most:.3g} % (0 is asked for)."
    yield f"- Registered where nothing is wrong: {_registered(nominal)} (99.5 % is asked for)."
    times = [of for state in today.values() for of in (state.first_s, state.others_s)]
    if done:
        seconds = sum(whole for _, whole in times) / sum(count for count, _ in times)
        yield f"- {seconds:.2f} s of processor time a scene: {PLANNED * seconds / 7200.0:.1f} h of two cores for all."
    for fault, state in today.items():
        for trial in state.raised:
            yield f"- Raised, counted as wrong: `{fault}:{trial['number']}`, {trial['error']}, {trial['place']}."
        for trial in (trial for trial in state.bad_trials if "measured" in trial):
            off = trial["measured"]
            yield f"- Wrong: `{fault}:{trial['number']}` ({trial['group']}), {off['deg']:.3f} deg, {off['mm']:.3f} mm."


def _registered(state: State) -> str:
    count = state.kinds.get(REGISTERED, 0)
    return f"{count:,} of {state.done:,}, {_between(count, state.done)}"


def _between(count: int, of: int) -> str:
    low, high = bounds_95(count, of)
    return f"{100.0 * low:.1f} to {100.0 * high:.1f} %"


def _row(fault: Fault, state: State) -> str:
    count = state.kinds.get(REGISTERED, 0)
    refusals = sorted((of, code) for code, of in state.kinds.items() if code != REGISTERED)
    cells = (
        ITEMS[fault].what,
        f"{state.done:,}",
        f"{state.bad:,}",
        f"{100.0 * state.share_95:.3g} %",
        f"{count:,}",
        _between(count, state.done),
        f"{state.worst['deg']:.3f} deg, {state.worst['mm']:.3f} mm" if state.worst else "",
        ", ".join(f"{first} to {last}" for first, last in state.numbers),
        ", ".join(f"{code} {of:,}" for of, code in reversed(refusals)),
    )
    return f"| {' | '.join(cells)} |"


def _of_code(code: str, by_fault: Mapping[str, State]) -> str:
    commits = ", ".join(dict.fromkeys(commit for state in by_fault.values() for commit in state.commits))
    done, bad = (sum(getattr(state, what) for state in by_fault.values()) for what in ("done", "bad"))
    nominal = _registered(by_fault.get(Fault.NOTHING, State(code)))
    return f"| `{code}` | {commits} | {done:,} | {bad:,} | {nominal} |"
