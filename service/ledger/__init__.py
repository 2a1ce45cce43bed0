"""The ledger: one chain of hashes over every record row, signed at checkpoints, anchored outside the database."""
