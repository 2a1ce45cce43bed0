"""Evidence that nothing acknowledged is lost: faults of the machine against the record of a whole case."""
