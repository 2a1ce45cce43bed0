"""What can be made wrong with the C-arm and the patient; the arm's faults are the controller's own."""

from enum import StrEnum


class RoomFault(StrEnum):
    """Each lasts from its injection until it is cleared."""

    FOREIGN_PATIENT = "foreign_patient"  # the worklist still holds somebody else
    WRONG_STUDY = "wrong_study"
    RESEND_OLD_IMAGE = "resend_old_image"  # the newest image so far is sent once more, nothing is exposed
    MIRRORED = "mirrored"  # the display's flip is on
    NO_PLATE = "no_plate"
    HALF_SCALE = "half_scale"  # the image is stored with half its rows and columns
    CARM_TURNED = "carm_turned"  # by 1 deg, dials unchanged
    CARM_SHIFTED = "carm_shifted"  # along the table by 8 mm: somebody leant on it
    BASE_PUSHED = "base_pushed"  # the arm's cart, by 8 mm; no encoder sees it
    GUIDE_SCALED = "guide_scaled"  # another size of guide is mounted, 3 % larger throughout
    TRUNCATED_ASSOCIATION = "truncated_association"  # the network breaks in the middle of an image
    ANATOMY_SHIFT = "anatomy_shift"  # the patient lies 1 mm further to the left
    LOW_DOSE = "low_dose"
    NO_BEAD = "no_bead"  # the bead fell out


CARM_TURN_DEG = 1.0
CARM_SHIFT_MM = BASE_PUSH_MM = 8.0
GUIDE_SCALE = 1.03
ANATOMY_SHIFT_MM = 1.0
LOW_DOSE_SHARE = 0.02
FOREIGN_PATIENT_ID, FOREIGN_PATIENT_NAME = "ELSE-0007", "Somebody^Else"
