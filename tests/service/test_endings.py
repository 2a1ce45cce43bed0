"""Whoever holds the button hears how the motion ended, and takes the news from nobody else."""

import asyncio

from service.motion.endings import Ending, Endings

ENDED = Ending("released", "case_open", 3, 0.0, 0.0, None)


def test_each_of_two_hands_on_one_permit_hears_the_ending() -> None:
    async def run() -> None:
        endings = Endings()
        with endings.expected("p") as first:
            with endings.expected("p") as second:
                pass
            endings.tell("p", ENDED)
            assert first.result() == ENDED
            assert not second.done()

    asyncio.run(run())


def test_an_ending_that_nobody_awaits_is_let_go() -> None:
    async def run() -> None:
        endings = Endings()
        endings.tell("p", ENDED)
        with endings.expected("p") as ending:
            endings.tell("q", ENDED)
            assert not ending.done()

    asyncio.run(run())
