"""The running service over its own sockets, in rooms whose arm, clock and image work follow a script."""
