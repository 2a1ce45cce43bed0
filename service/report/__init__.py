"""The report of a case: what was done, measured, decided and signed, as a PDF/A for people and archives."""
