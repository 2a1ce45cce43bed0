"""3D Slicer: plans come in from its markups, poses, target, status and images go out live."""
