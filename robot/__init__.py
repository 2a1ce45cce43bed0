"""The arm: protocol, UR5 driver, kinematics, path check, and the guard process that alone may move it."""
