"""The rules: states, triggers, transition table, interlocks, artefact chain. Pure Python, no I/O."""
