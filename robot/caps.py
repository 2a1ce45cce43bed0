"""What no motion near a patient may pass, whoever planned it; the guard holds to these by itself (H12)."""

import numpy as np

SPEED_CAP_MM_S = 20.0  # a heartbeat lost at this speed costs 10 to 15 mm of travel at worst
TURN_SPEED_CAP_RAD_S = float(np.deg2rad(5.0))
ACCELERATION_CAP_MM_S2 = 50.0  # full speed after 0.4 s
LENGTH_CAP_MM = 150.0  # of one held motion: a longer way is approved in pieces
ANGLE_CAP_RAD = float(np.deg2rad(35.0))
