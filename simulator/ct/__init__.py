"""A CT as the simulated patient: read, checked, and seen by the C-arm."""
