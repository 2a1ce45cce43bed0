"""Image in, geometry out: distortion, rings, line, bead, registration, targeting, evaluation, C-arm angles."""
