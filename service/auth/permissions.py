"""The one permission table: which role may do what. Stop is in it for everyone."""

from enum import StrEnum


class Role(StrEnum):
    """The roles of a room."""

    SURGEON = "surgeon"
    OPERATOR = "operator"  # the radiographer
    ENGINEER = "engineer"
    AUDITOR = "auditor"


class Permission(StrEnum):
    """What a route asks for."""

    READ = "read"  # cases, status, events, images, devices
    READ_AUDIT = "read_audit"
    STOP = "stop"
    OPEN_CASE = "open_case"
    CLOSE_CASE = "close_case"
    STATE_FACT = "state_fact"  # the C-arm, the patient or the arm moved; what is in the guide
    POSITION_CARM = "position_carm"
    EXPOSE = "expose"  # request an exposure, retake, reuse or upload an image
    TARGET = "target"
    PLAN = "plan"
    APPROVE = "approve"  # permits, insertion, acknowledgement
    MOVE = "move"  # the held button
    HOLD = "hold"  # pause
    TAKE_LEASE = "take_lease"
    NOTE = "note"
    UPLOAD_DEVICE = "upload_device"
    CALIBRATE = "calibrate"


_EVERYONE = frozenset({Permission.READ, Permission.STOP})
_STAFF = _EVERYONE | {Permission.STATE_FACT, Permission.HOLD, Permission.NOTE}
_IMAGING = frozenset({Permission.POSITION_CARM, Permission.EXPOSE})

ROLE_PERMISSIONS: dict[Role, frozenset[Permission]] = {
    Role.SURGEON: _STAFF
    | _IMAGING
    | {
        Permission.OPEN_CASE,
        Permission.CLOSE_CASE,
        Permission.TARGET,
        Permission.PLAN,
        Permission.APPROVE,
        Permission.MOVE,
        Permission.TAKE_LEASE,
        Permission.READ_AUDIT,
        Permission.UPLOAD_DEVICE,
    },
    Role.OPERATOR: _STAFF | _IMAGING | {Permission.OPEN_CASE},
    Role.ENGINEER: _STAFF | {Permission.UPLOAD_DEVICE, Permission.CALIBRATE, Permission.READ_AUDIT},
    Role.AUDITOR: _EVERYONE | {Permission.READ_AUDIT},
}


def allows(role: Role, permission: Permission) -> bool:
    """Whether the table gives `role` the permission."""
    return permission in ROLE_PERMISSIONS[role]
