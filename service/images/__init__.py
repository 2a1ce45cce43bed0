"""Images: receiving, keeping and handing out the original bytes."""
