"""`coaxial audit`: read the ledger, export it, verify it, replay cases, show the public key of its checkpoints.

Exit status: 0 done, 1 the verification found something, 3 refused; replay has its own. What is heavy is imported where
it is used.
"""

import os
import time
from datetime import datetime
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from service.cli.plain import plain_typer
from service.cli.replay import replay
from service.cli.site import ConfigOption, DataFolderOption, site_settings

if TYPE_CHECKING:
    from service.database.engines import Database
    from service.ledger.findings import Verification
    from service.ledger.keys import Verifier
    from service.ledger.listing import Wanted
    from service.settings import Settings

audit = plain_typer(no_args_is_help=True)
audit.command()(replay)

_FOUND = 1
_SHOWN = 100


class FormatOption(StrEnum):
    """Choices of --format; the values are those of service.ledger.exports.ExportFormat."""

    JSONL = "jsonl"
    CSV = "csv"
    DICOM = "dicom"
    FHIR = "fhir"


Since = Annotated[datetime | None, typer.Option(help="UTC.")]
Until = Annotated[datetime | None, typer.Option(help="UTC; this moment is not in it.")]
After = Annotated[int, typer.Option(help="Entries behind this number.", min=0)]


@audit.callback()
def audits() -> None:
    """The record: read it, verify it, compute it anew."""


@audit.command()
def key(
    new: Annotated[
        bool, typer.Option("--new", help="Make one where there is none, though the record was signed with another.")
    ] = False,
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """Print the public key: keep it outside this machine, and verify with it."""
    from service.errors import ErrorCode, ServiceError
    from service.ledger.keys import kept_key, signing_key

    with site_settings(config, data_folder) as settings:
        signer = signing_key(settings.key_file) if new else kept_key(settings.key_file)
        if signer is None:
            raise ServiceError(ErrorCode.KEY_MISSING, f"there is no key {settings.key_file}")
        typer.echo(f"private key: {settings.key_file}\npublic key, SHA-256 {signer.verifier.name}:", err=True)
        typer.echo(signer.verifier.pem, nl=False)


def _add_printing(name: str, usual_limit: int, usual_form: FormatOption, purpose: str) -> None:
    """A command that prints entries, so many and in this form unless it is told otherwise."""

    @audit.command(name, help=purpose)
    def print_entries(
        case: Annotated[str | None, typer.Option(help="Id of a case, or an unambiguous beginning of it.")] = None,
        actor: Annotated[str | None, typer.Option(help="Name or id of a user.")] = None,
        action: Annotated[str | None, typer.Option(help="What was done, as the entries name it.")] = None,
        interlock: Annotated[str | None, typer.Option(help="Code of an interlock that gave a verdict.")] = None,
        hazard: Annotated[str | None, typer.Option(help="Hazard whose interlock gave one, as H04.")] = None,
        since: Since = None,
        until: Until = None,
        after: After = 0,
        limit: Annotated[int, typer.Option(help="At most so many; 0: all.", min=0)] = usual_limit,
        form: Annotated[FormatOption, typer.Option("--format", help="How each entry is written.")] = usual_form,
        config: ConfigOption = None,
        data_folder: DataFolderOption = None,
    ) -> None:
        words = (case, actor, action, interlock, hazard)
        with site_settings(config, data_folder) as settings:
            _print(settings, f"audit {name}", words, (since, until), after, limit or None, form)


_add_printing(
    "list",
    200,
    FormatOption.CSV,
    "Print entries, oldest first: CSV for reading, JSON Lines for every entry whole. This is an entry itself.",
)
_add_printing(
    "export",
    0,
    FormatOption.JSONL,
    "Print every entry, a line each: whole, or as DICOM audit messages (PS3.15 A.5) or FHIR AuditEvents.",
)


def _print(
    settings: "Settings",
    what: str,
    words: tuple[str | None, ...],
    times: tuple[datetime | None, ...],
    after: int,
    limit: int | None,
    form: FormatOption,
) -> None:
    from service.audit import record_reading
    from service.cases import store
    from service.database.clock import as_utc
    from service.database.current import present_database
    from service.ledger.exports import ExportFormat, export
    from service.ledger.listing import Wanted

    case, *others = words
    with present_database(settings) as database:
        with database.read() as connection:
            case = store.whole_id(connection, case) if case else None
        wanted = Wanted(case, *others, *(as_utc(at) if at is not None else None for at in times))
        lines = export(database, wanted, ExportFormat(form), after, limit)
        record_reading(database, None, what, {"after": after, "limit": limit, "format": form.value})
        for text in lines:
            typer.echo(text, nl=False)
        _tell_the_end(database, wanted, after, limit)


def _tell_the_end(database: "Database", wanted: "Wanted", after: int, limit: int | None) -> None:
    """On stderr, where nothing fits or the limit cut the list: read without a word, either passes for all there is."""
    from service.ledger.listing import page

    with database.read() as connection:
        found = page(connection, wanted, after, (limit or 0) + 1)
    if not found:
        typer.echo("no entry fits", err=True)
    elif limit is not None and len(found) > limit:
        typer.echo(f"{limit} entries, and there are more: --after {found[limit - 1]['sequence']}", err=True)


@audit.command()
def verify(
    public_key: Annotated[
        list[Path] | None, typer.Option(help="Public key (PEM), again for each; else the one beside the private key.")
    ] = None,
    anchor: Annotated[Path | None, typer.Option(help="Anchor file; else that of the settings.")] = None,
    workers: Annotated[int, typer.Option(help="Processes; they yield to other work.", min=1)] = os.cpu_count() or 1,
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """Find every change, insertion, deletion, swap, cut and rewriting, and say where. Nothing is repaired."""
    from service.database.current import check_present
    from service.database.engines import open_database
    from service.database.migrate import check_current
    from service.ledger.verifying import verify as verify_ledger

    with site_settings(config, data_folder) as settings:
        check_present(settings)
        database = open_database(settings.database_url)
        try:
            check_current(database)
            verifiers, started_s = _verifiers(settings, public_key), time.monotonic()
            found = verify_ledger(database, verifiers, anchor or settings.anchor_file, workers, _progress)
        finally:
            database.close()
        _tell(found, time.monotonic() - started_s)
        _record(settings, found)
    if found.findings:
        raise typer.Exit(_FOUND)


def _verifiers(settings: "Settings", named: list[Path] | None) -> "dict[str, Verifier]":
    from service.errors import ErrorCode, ServiceError
    from service.ledger.keys import public_file, public_key

    own = public_file(settings.key_file)
    if not named and not own.is_file():
        raise ServiceError(ErrorCode.KEY_MISSING, f"{own} is not here: verify with the one that you kept, --public-key")
    verifiers = [public_key(file) for file in named or [own]]
    return {verifier.name: verifier for verifier in verifiers}


def _progress(entries: int) -> None:
    typer.echo(f"\r{entries} entries", nl=False, err=True)


def _tell(found: "Verification", took_s: float) -> None:
    typer.echo("", err=True)
    for finding in found.findings[:_SHOWN]:
        typer.echo(f"{finding.where}: {finding.what}")
    if len(found.findings) > _SHOWN:
        typer.echo(f"and {len(found.findings) - _SHOWN} more")
    entries = f"{found.entries} entries, anchored up to {found.anchored}"
    looked_at = f"{entries}; {found.rows} rows, {found.checkpoints} checkpoints"
    rate = f"{took_s:.1f} s, {found.entries / max(took_s, 1e-3):.0f} entries a second"
    typer.echo(f"{looked_at} in {rate}: {len(found.findings) or 'nothing'} found")


def _record(settings: "Settings", found: "Verification") -> None:
    """That somebody looked is an entry itself, where the ledger still takes one."""
    from service.audit import record_audit
    from service.database.current import present_database
    from service.errors import ServiceError

    try:
        with present_database(settings) as database, database.write() as connection:
            data = {"entries": found.entries, "findings": len(found.findings)}
            record_audit(connection, "ledger_verified", None, data)
    except ServiceError as error:
        typer.echo(f"not recorded: {error.message}", err=True)
