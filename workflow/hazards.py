"""What can go wrong in the room and what the system must then do: the hazards that interlocks and tests name."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Hazard:
    """One way to harm: what it is, where it comes from, and what is required against it."""

    code: str
    name: str
    cause: str
    requirement: str


_LIST = (
    Hazard(
        "H01",
        "Another patient's image is used",
        "a wrong entry of the worklist",
        "An image whose patient or study is not the open case's enters no chain; it is kept in quarantine.",
    ),
    Hazard(
        "H02",
        "An old image is taken for a new one",
        "an image sent again, a cache",
        "An image is used only if its UID and pixels are new, it came in the requested window, and the C-arm's own "
        "clock says that it is newer than the image before.",
    ),
    Hazard(
        "H03",
        "The C-arm moved after the registration",
        "a bump, a drive, a drift",
        "A verifying image whose rings moved otherwise than the arm voids the view; nothing is aimed with an image "
        "beyond its age.",
    ),
    Hazard(
        "H04",
        "The arm or its base moved around or after the image",
        "a push, the pendant, a cart that gives way",
        "The arm is still from exposure to arrival; every displacement since that the guard did not command voids "
        "the image and what is below it.",
    ),
    Hazard(
        "H05",
        "The image is mirrored or turned",
        "a display setting of the C-arm",
        "A mirrored image is refused, never mirrored back; a turned one registers right or is refused.",
    ),
    Hazard(
        "H06",
        "The pixel scale is wrong, or distortion is not corrected",
        "a missing plate, a scaled image",
        "An intensifier's image needs its plate; a scale that differs from the C-arm file's is refused.",
    ),
    Hazard(
        "H07",
        "Rings are confused with anatomy or instruments",
        "clutter, occlusion, decoys",
        "A registration is accepted only if its redundancy, residual, coverage and predicted error pass; what is "
        "ambiguous is refused.",
    ),
    Hazard(
        "H08",
        "The target is meant in another pixel space",
        "zoom, shift, the screen's pixel ratio",
        "A target is confirmed only after the service drew it back into its own picture of the named image.",
    ),
    Hazard(
        "H09",
        "Units are mixed up",
        "m for mm, degrees for radians",
        "Every number that comes in has a unit in its name and a plausible range; what is outside is refused by name.",
    ),
    Hazard(
        "H10",
        "The tool calibration or a device file is not the one in use",
        "an old calibration, a changed tool",
        "Device files carry version, hash and expiry; before and during a motion the controller's TCP and payload "
        "are those of the file.",
    ),
    Hazard(
        "H11",
        "The arm comes to a singularity, another branch or a joint's limit",
        "an unlucky goal",
        "A path is planned only if its joints follow without a leap, with margin to limits and singularities.",
    ),
    Hazard(
        "H12",
        "The arm hits patient, table or intensifier",
        "an obstacle on the way",
        "The swept volume keeps clear of the room file's shapes, speeds stay below the caps, and a rise of force "
        "stops.",
    ),
    Hazard(
        "H13",
        "The arm moves without confirmation",
        "a wrong call, a loose finger",
        "No motion starts without a surgeon's permit and a live held button.",
    ),
    Hazard(
        "H14",
        "A command is carried out twice",
        "a double tap, a retry",
        "Equal requests have one effect and one answer; a permit starts one motion.",
    ),
    Hazard(
        "H15",
        "Two tablets command",
        "a shift change",
        "Only the holder of the newest control lease aims and moves; stop is open to all.",
    ),
    Hazard(
        "H16",
        "Tablet or network are lost amid a motion",
        "a dead battery, a gap in the radio",
        "200 ms without a live heartbeat stop the arm; nothing resumes.",
    ),
    Hazard(
        "H17",
        "A process dies amid a motion",
        "a crash",
        "Each process that dies stops the arm; after a start nothing moves before an acknowledgement.",
    ),
    Hazard(
        "H18",
        "The controller stops the arm by itself",
        "protective, safeguard or emergency stop",
        "The stop is latched, the permit void; a person acknowledges, and the next plan starts from the live pose.",
    ),
    Hazard(
        "H19",
        "Two services command one arm",
        "a second start",
        "Room and arm are claimed exclusively; whoever comes second refuses to start.",
    ),
    Hazard(
        "H20",
        "A hung program keeps the watchdog fed",
        "a stuck process",
        "The controller's watchdog is fed by nothing but the surgeon's newest heartbeat.",
    ),
    Hazard(
        "H21",
        "The arm's feedback is frozen, no number, out of order or late",
        "a fault of controller or network",
        "Readings count only while the controller's time advances, as fast as the clock here, and all values are "
        "finite; else the motion ends.",
    ),
    Hazard(
        "H22",
        "Something void is used",
        "a step back, a plan kept too long",
        "Whatever changes voids all that was made from it; every step names what it was made from.",
    ),
    Hazard(
        "H23",
        "A clock jumps",
        "a time server, a hand, a workstation that sleeps",
        "Ages are measured by monotonic clocks, minutes by one that goes on in sleep; order is by number; wall time"
        " decides nothing.",
    ),
    Hazard(
        "H24",
        "The disk is full or fails",
        "images, a log, a broken disk",
        "Without a written intent nothing moves; stop and reading go on.",
    ),
    Hazard(
        "H25",
        "The power fails amid a transaction",
        "a plug",
        "What was acknowledged is durable, what was not is not half there.",
    ),
    Hazard(
        "H26",
        "The record is altered, cut or rolled back",
        "anybody with the file",
        "Every altered, removed, added or swapped record, and every older copy, is found by verification.",
    ),
    Hazard(
        "H27",
        "Somebody else commands in a session's name",
        "a stolen token, another site's page",
        "Every request needs a live session with the permission, and so does a held button all the while; tokens end, "
        "wrong answers lock, other origins are refused.",
    ),
    Hazard(
        "H28",
        "The verification uses an image from before the motion",
        "an image on its way",
        "Only an image requested and taken after the arm came to rest verifies; only such a verification lets insert.",
    ),
    Hazard(
        "H29",
        "The arm can move while a sleeve goes in",
        "a command, a program still running",
        "An insertion starts with the program stopped and motion locked; the pose is watched, and a drift alarms.",
    ),
    Hazard(
        "H30",
        "Program or settings change amid a case",
        "an update, an edited file",
        "A case is pinned to program, settings and device files; under others it can only be ended.",
    ),
    Hazard(
        "H31",
        "Malformed input breaks the service",
        "a broken sender, an attack",
        "Sizes are bounded, decoders run apart, and what cannot be read is refused with the state unchanged.",
    ),
    Hazard(
        "H32",
        "Load delays the stop",
        "image work, a busy database",
        "Stop and heartbeat wait for no image work and no database; the guard is a process of its own.",
    ),
    Hazard(
        "H33",
        "The two evaluations disagree",
        "a wrong guide file, a bug",
        "Both are computed at each verification; a disagreement beyond their bounds verifies nothing.",
    ),
    Hazard(
        "H34",
        "The patient moved between two images",
        "a breath, a cough",
        "A shift of the anatomy beyond its limit voids the image; what cannot be measured verifies nothing.",
    ),
    Hazard(
        "H35",
        "The arm moves with an instrument in the guide",
        "a forgotten sleeve or wire",
        "The arm moves only with a guide that a person stated empty, or along the axis over a wire.",
    ),
    Hazard(
        "H36",
        "Old heartbeats are taken for live ones",
        "buffers, a slow network",
        "A heartbeat counts for as old as the guard's challenge that it echoes; 200 ms are silence.",
    ),
)
HAZARDS: dict[str, Hazard] = {hazard.code: hazard for hazard in _LIST}
