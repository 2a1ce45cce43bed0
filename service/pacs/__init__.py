"""The hospital's DICOM peers: the worklist that says who is next, the archive that takes what a case came to."""
