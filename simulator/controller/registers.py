"""The general purpose registers through which a client and the running script talk."""

from simulator.controller.framing import Value

REGISTERS = 48


class Registers:
    """Inputs are written by clients and kept when they leave; outputs are written by the script."""

    def __init__(self) -> None:
        self.input_integers = [0] * REGISTERS
        self.input_doubles = [0.0] * REGISTERS
        self.output_integers = [0] * REGISTERS
        self.output_doubles = [0.0] * REGISTERS

    def write_input(self, name: str, value: Value) -> None:
        """Store an input field that is a register; the others (digital outputs, forces) move nothing here."""
        kind, _, index = name.rpartition("_")
        if kind == "input_int_register":
            self.input_integers[int(index)] = int(value)  # type: ignore[arg-type]  # the recipe makes it scalar
        elif kind == "input_double_register":
            self.input_doubles[int(index)] = float(value)  # type: ignore[arg-type]  # the recipe makes it scalar
