"""The guard: a process of its own that alone may move the arm."""
