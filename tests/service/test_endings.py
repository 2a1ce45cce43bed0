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


def test_an_end_of_everything_is_heard_by_every_hand_that_has_not_heard_its_own() -> None:
    async def run() -> None:
        endings, lost = Endings(), Ending("guard_lost", "safe_hold", 4, None, None, None)
        with endings.expected("p") as first, endings.expected("q") as second:
            endings.tell("p", ENDED)
            endings.tell_all(lost)
            assert (first.result(), second.result()) == (ENDED, lost)

    asyncio.run(run())


def test_an_ending_that_nobody_awaits_is_let_go() -> None:
    async def run() -> None:
        endings = Endings()
        endings.tell("p", ENDED)
        with endings.expected("p") as ending:
            endings.tell("q", ENDED)
            assert not ending.done()

    asyncio.run(run())
