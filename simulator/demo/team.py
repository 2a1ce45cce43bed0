"""Who works at one case."""

from dataclasses import dataclass

from coaxial_client import Case
from simulator.demo.door_client import Door
from simulator.demo.telling import Teller


@dataclass(frozen=True, slots=True)
class Team:
    """Surgeon and radiographer at one case, each with a tablet, and the room they stand in.

    What the service observes is read by the surgeon: the record is not the radiographer's to read.
    """

    surgeon: Case
    operator: Case
    pin: str
    door: Door
    teller: Teller
