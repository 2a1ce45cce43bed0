"""A service does not start on an arm that another one runs (H19); from then on its guard holds the arm's claim."""

import time

from robot.arm_claim import ArmClaim
from robot.errors import ArmClaimedError, ArmUnreachableError, ControllerRefusedError
from service.errors import ServiceError

# The guard of a service that was killed stops its arm, waits for its rest and ends; a new service waits for that.
_FREED_WITHIN_S = 6.0
_AGAIN_S = 0.1


def refuse_claimed_arm(address: str | None) -> None:
    """ServiceError arm_claimed if somebody else runs the arm; one that is away is nobody's."""
    if address is None:
        return
    claim, end_s = ArmClaim(address), time.monotonic() + _FREED_WITHIN_S
    while True:
        try:
            claim.take()
        except ArmClaimedError as error:
            if time.monotonic() > end_s:
                raise ServiceError(error.code, str(error)) from error
            time.sleep(_AGAIN_S)
        except (ArmUnreachableError, ControllerRefusedError):
            return  # the guard tries again, and takes no motion before it holds the claim
        else:
            claim.give_up()
            return
