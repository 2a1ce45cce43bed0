"""Valid inputs with a few things wrong, by the million: taken, or refused with a type, and within a second."""
