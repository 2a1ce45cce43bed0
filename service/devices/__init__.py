"""Versioned device files: guide, C-arm, tool, room."""
