"""What keeps the ledger ends when it is told to, whatever is recorded at that moment."""

import asyncio
from contextlib import closing
from types import SimpleNamespace

import pytest

from service.audit import record_audit
from service.ledger.keeping import keeping_ledger
from service.settings import Settings


@pytest.mark.parametrize("steps", range(8))
def test_a_commit_at_the_very_end_does_not_keep_it_running(record, tmp_path, steps) -> None:
    async def whole(database) -> None:
        parts = SimpleNamespace(database=database, settings=Settings(data_folder=tmp_path))
        async with keeping_ledger(None, parts):
            await asyncio.sleep(0.6)  # until it waits for the next commit
            with database.write() as connection:
                record_audit(connection, "signed_out", None, {})
            for _ in range(steps):  # of the event loop, between the commit and the end
                await asyncio.sleep(0)

    with closing(record.open()) as database:
        asyncio.run(asyncio.wait_for(whole(database), 10.0))
