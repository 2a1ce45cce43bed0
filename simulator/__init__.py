"""A simulated operating room that speaks only the protocols of a real one."""
