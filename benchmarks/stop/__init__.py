"""How soon a stop is on the wire when everything else is busy (`make bench-stop`)."""
