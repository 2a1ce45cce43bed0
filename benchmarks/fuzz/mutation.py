"""Hostile bytes: a valid input with a few things wrong. The same random numbers make the same bytes."""

import re
import zlib
from collections.abc import Callable, Sequence
from random import Random

Change = Callable[[bytearray, Random], None]

_MOST_CHANGES = 3
# Where counts and lengths overflow, change their sign or end a buffer.
_EDGES = (0, 1, 2, 0x7F, 0x80, 0xFF, 0x100, 0x7FFF, 0x8000, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFE, 0xFFFFFFFF)
_WIDTHS = (1, 2, 4)  # bytes of a length field
_LONGEST_PART = 64  # bytes cut out, repeated or taken from elsewhere
_TOKEN = re.compile(rb'"[^"]*"|[A-Za-z0-9_.+-]+|[^\s\w]')
# What parsers of text stumble on: numbers too large, too deep, not finite; characters that are none.
WORDS = (
    *(b"0", b"-1", b"1e999", b"1" + b"0" * 400, b"0x" + b"f" * 99, b"9" * 5000, b"nan", b"-inf", b"NaN", b"Infinity"),
    *(b"null", b"true", b"[]", b"{}", b'""', b"[" * 3000, b"[" * 900 + b"]" * 900, b'"\\u0000"', b'"\\ud800"'),
    *(b'"\xff"', b"\x00", b"\xef\xbb\xbf", b'"' + b"x" * 70_000 + b'"', b"2027-13-99", b"2027-12-31T00:00:00", b"\\"),
)


def mutated(seed: bytes, changes: Sequence[Change], random: Random) -> bytes:
    """The seed after one to three of the changes."""
    data = bytearray(seed)
    for _ in range(random.randint(1, _MOST_CHANGES)):
        random.choice(changes)(data, random)
    return bytes(data)


def changes_of_bytes(head: int, others: Sequence[bytes]) -> tuple[Change, ...]:
    """Changes of binary data, three in four within its first `head` bytes; parts are taken over from `others`."""

    def place(data: bytearray, random: Random) -> int:
        return random.randrange(max(1, min(len(data), head) if random.random() < 0.75 else len(data)))

    def flip(data: bytearray, random: Random) -> None:
        if data:
            data[place(data, random) % len(data)] ^= 1 << random.randrange(8)

    def number(data: bytearray, random: Random) -> None:
        at, width = place(data, random), random.choice(_WIDTHS)
        value = random.choice(_EDGES) % (1 << 8 * width)
        data[at : at + width] = value.to_bytes(width, random.choice(("little", "big")))

    def cut(data: bytearray, random: Random) -> None:
        at = place(data, random)
        del data[at : at + random.randint(1, _LONGEST_PART)]

    def repeat(data: bytearray, random: Random) -> None:
        at = place(data, random)
        data[at:at] = data[at : at + random.randint(1, _LONGEST_PART)]

    def truncate(data: bytearray, random: Random) -> None:
        if random.random() < 0.25:  # else little would be left of most
            del data[place(data, random) :]

    def splice(data: bytearray, random: Random) -> None:
        at, length = place(data, random), random.randint(1, _LONGEST_PART)
        data[at : at + length] = random.choice(others)[at : at + length]

    return flip, flip, flip, number, number, number, splice, cut, repeat, truncate


def changes_of_text(words: Sequence[bytes], others: Sequence[bytes]) -> tuple[Change, ...]:
    """Changes of text, token by token, and now and then of its bytes."""

    def replace(data: bytearray, random: Random) -> None:
        if found := _token(data, random):
            data[slice(*found)] = random.choice(words)

    def exchange(data: bytearray, random: Random) -> None:
        first, second = _token(data, random), _token(data, random)
        if first and second:
            data[slice(*first)] = data[slice(*second)]

    def byte(data: bytearray, random: Random) -> None:
        random.choice(of_bytes)(data, random)

    of_bytes = changes_of_bytes(1 << 20, others)
    return replace, replace, replace, exchange, exchange, byte


def _token(data: bytearray, random: Random) -> tuple[int, int] | None:
    """Where a token near a random place begins and ends."""
    found = _TOKEN.search(data, random.randrange(len(data))) if data else None
    return None if found is None else found.span()


def with_right_checksums(png: bytes) -> bytes:
    """The checksum of each chunk made right, so that a decoder looks at what is in it."""
    data, at = bytearray(png), 8
    while at + 12 <= len(data):
        end = at + 8 + int.from_bytes(data[at : at + 4], "big")
        data[end : end + 4] = zlib.crc32(data[at + 4 : end]).to_bytes(4, "big")
        at = end + 4
    return bytes(data)
