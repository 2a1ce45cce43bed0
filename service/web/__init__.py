"""The tablet: a client of the public interface, served by the service itself."""
