"""The `coaxial` command."""
