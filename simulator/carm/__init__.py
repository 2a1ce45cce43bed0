"""The C-arm of the simulated room: geometry, images, and their way out by DICOM."""
