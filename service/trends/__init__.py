"""How cases go over time, by device: figures of every finished case, control charts, what drifts."""
