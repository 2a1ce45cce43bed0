"""Cases as append-only events with the artefacts each one made."""
