"""The bridge to the guard: what it says becomes observations; the held button; the watch over an insertion."""
