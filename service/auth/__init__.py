"""Who may do what: users, sessions, permissions, lock-out, control lease."""
