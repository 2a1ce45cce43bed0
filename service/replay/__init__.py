"""Replay: every recorded result of a case computed anew from the stored bytes, and compared with the record."""
