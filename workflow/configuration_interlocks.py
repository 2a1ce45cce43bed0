"""The interlock of what decides: program, settings and device files are those that the case was opened with."""

from workflow.checks import Interlock
from workflow.findings import Finding, age_note, fresh
from workflow.inquiry import Inquiry

# Enough of a hash for a person to tell two apart.
_SHOWN = 12


def _pinned(inquiry: Inquiry) -> Finding:
    snapshot, age_s = inquiry.snapshot, inquiry.limits.record_age_s
    now, opened = fresh(snapshot.configuration, age_s), fresh(snapshot.configuration_opened, age_s)
    return Finding(
        now is not None and now == opened,
        now and now[:_SHOWN],
        opened and opened[:_SHOWN],
        note=age_note(snapshot.configuration, age_s) or age_note(snapshot.configuration_opened, age_s),
    )


CONFIGURATION = Interlock(
    "configuration", "H30", "program, settings or device files are not those that the case was opened with", _pinned
)
