"""Tells whoever asked that an image is stored: the hook between the DICOM receiver and the procedure."""

import threading
from collections.abc import Callable

import structlog

_log = structlog.get_logger(__name__)

OnImageStored = Callable[[str], None]


class ImageArrivals:
    """Calls every listener with the image id, once, after the bytes are committed, on the receiver's thread.

    A listener that works on an event loop hands over with `loop.call_soon_threadsafe`. The sender has its success
    answer only after the listeners return, so they must be quick.
    """

    def __init__(self) -> None:
        self._listeners: list[OnImageStored] = []
        self._lock = threading.Lock()

    def listen(self, on_image_stored: OnImageStored) -> None:
        """Call `on_image_stored(image_id)` for every image from now on, usable or not (`images.problem`)."""
        with self._lock:
            self._listeners.append(on_image_stored)

    def announce(self, image_id: str) -> None:
        """Tell every listener."""
        with self._lock:
            listeners = tuple(self._listeners)
        for listener in listeners:
            try:
                listener(image_id)
            except Exception:  # noqa: BLE001  the bytes are committed: whatever a listener does, the sender is told so
                _log.exception("image_listener_failed", image_id=image_id)
