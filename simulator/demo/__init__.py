"""A whole procedure, driven from outside: the service's public interface and the room's door, nothing else."""
