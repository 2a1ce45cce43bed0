"""The running service of the service's own tests."""

from tests.service.conftest import running

__all__ = ["running"]
