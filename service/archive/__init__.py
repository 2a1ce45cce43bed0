"""A case as one file: everything that was recorded of it, with the proof, for another machine or another time."""
