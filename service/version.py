"""The version of the installed product, as records name it."""

from importlib.metadata import version

PRODUCT_VERSION = version("coaxial")
