"""`coaxial case`: which cases there are; one as a report, or as one file to be kept, checked, given away, brought in.

Exit status: 0 done, 1 the check found something, 2 a file that cannot be written there, 3 refused. What is heavy is
imported where it is used.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from service.cli.plain import plain_typer
from service.cli.site import ConfigOption, DataFolderOption, in_one_line, site_settings
from service.cli.streams import place_of, write_file

if TYPE_CHECKING:
    from service.conductor.case_list import ListedCase
    from service.database.engines import Database
    from service.ledger.keys import Verifier

case = plain_typer(no_args_is_help=True)

_FOUND = 1
_SHOWN = 100
_MOST = 1000  # cases of one list
CaseId = Annotated[str, typer.Argument(metavar="CASE", help="Id of the case, or an unambiguous beginning of it.")]
ArchiveFile = Annotated[Path, typer.Argument(metavar="FILE", help="An archive of a case.")]
PublicKeys = Annotated[
    list[Path] | None,
    typer.Option("--public-key", help="Public key (PEM) to be believed, again for each; else the one in the file."),
]


@case.callback()
def cases() -> None:
    """Which cases there are; one as a report, or as one file: export, verify, import."""


@case.command("list")
def list_all(
    limit: Annotated[int, typer.Option(help="At most so many.", min=1, max=_MOST)] = 100,
    before: Annotated[str | None, typer.Option(metavar="CASE", help="Those that were opened before this case.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object a case instead of the table.")] = False,
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """Print the cases, newest first: id, when, state, room, who opened it, targets; no word of the patient."""
    from service.cases import store
    from service.conductor.case_list import listed_cases
    from service.database.current import present_database

    with (
        site_settings(config, data_folder) as settings,
        present_database(settings) as database,
        database.read() as connection,
    ):
        found = listed_cases(connection, limit + 1, store.whole_id(connection, before) if before else None)
    _print_cases(found[:limit], as_json=as_json)
    if len(found) > limit:
        typer.echo(f"{limit} cases, and there are more: --before {found[limit - 1].id}", err=True)
    elif not found:
        typer.echo("no case", err=True)


def _print_cases(cases: "Sequence[ListedCase]", *, as_json: bool) -> None:
    if as_json:
        for one in cases:
            typer.echo(json.dumps(asdict(one)))
        return
    rows = [("case", "opened", "ended", "state", "room", "opened by", "targets placed")]
    rows += [
        (one.id, one.opened_at[:19], (one.ended_at or "")[:19], one.state, one.room, one.opened_by, _placed(one))
        for one in cases
    ]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        typer.echo("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())


def _placed(one: "ListedCase") -> str:
    return f"{one.targets_placed}/{one.targets_planned}"


@case.command("report")
def report_one(
    case_id: CaseId,
    out: Annotated[
        Path | None, typer.Option(help="Where to write it; case-CASE.pdf in this folder if not told.")
    ] = None,
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """Write the report of a case, open ones too, as PDF/A; the same record gives the same file."""
    import asyncio

    from service.database.current import present_database
    from service.report.making import make_report
    from service.vision_worker import VisionWorker

    async def make() -> bytes:
        vision = VisionWorker(settings.vision)
        try:
            return await make_report(database, vision, case_id)
        finally:
            await vision.close()

    with site_settings(config, data_folder) as settings, present_database(settings) as database:
        case_id = _whole_id(database, case_id)
        content = asyncio.run(make())
    file = out or Path(f"case-{case_id}.pdf")
    write_file(file, content)
    typer.echo(str(file))


@case.command("export")
def export_one(
    case_id: CaseId,
    out: Annotated[Path, typer.Option(help="Where to write it.")],
    pseudonymise: Annotated[bool, typer.Option(help="Without patient, people and what they wrote.")] = False,
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """Write everything that was recorded of a case, with its proof; the same case gives the same file."""
    from service.archive.exporting import export_case
    from service.database.current import check_present, current_database
    from service.ledger.keys import signing_key

    place = place_of(out)
    with site_settings(config, data_folder) as settings:
        check_present(settings)
        with current_database(settings) as database:
            signer, case_id = signing_key(settings.key_file), _whole_id(database, case_id)
            export_case(database, signer, case_id, None, place, pseudonymised=pseudonymise)
    typer.echo(f"{out}: signed by key {signer.verifier.name}")


@case.command("verify")
def verify_file(file: ArchiveFile, public_key: PublicKeys = None) -> None:
    """Check an archive by itself: signature, chain, every row and every byte; say where it fails."""
    from service.archive.checking import check_archive
    from service.archive.container import open_archive

    with in_one_line(), open_archive(file) as archive:
        manifest, found = archive.manifest, check_archive(archive, _trusted(public_key))
    for finding in found.findings[:_SHOWN]:
        typer.echo(f"{finding.where}: {finding.what}")
    if manifest["pseudonymised"] is not None:
        typer.echo(manifest["pseudonymised"])
    known = "a key that you named" if public_key else "the key in the file: compare it with `coaxial audit key`"
    counted = f"{len(manifest['members'])} members, {found.rows} rows, {found.entries} entries"
    typer.echo(f"case {manifest['case_id']}: {counted}; signed by {manifest['key']}, {known}")
    typer.echo(f"{len(found.findings) or 'nothing'} found")
    if found.findings:
        raise typer.Exit(_FOUND)


@case.command("import")
def import_file(
    file: ArchiveFile, public_key: PublicKeys = None, config: ConfigOption = None, data_folder: DataFolderOption = None
) -> None:
    """Bring a case into this database, with its own ids; one that was under way is held here until acknowledged."""
    from service.archive.container import open_archive
    from service.archive.importing import import_case
    from service.database.current import current_database

    with site_settings(config, data_folder) as settings:
        trusted = _trusted(public_key)
        with open_archive(file):  # a record is not begun for a file that is no archive
            pass
        with current_database(settings) as database:
            case_id, is_new = import_case(database, settings, file, trusted)
    typer.echo(f"case {case_id} is here" if is_new else f"case {case_id} was here already, the same")


def _whole_id(database: "Database", beginning: str) -> str:
    from service.cases import store

    with database.read() as connection:
        return store.whole_id(connection, beginning)


def _trusted(files: list[Path] | None) -> "dict[str, Verifier]":
    from service.ledger.keys import public_key

    verifiers = [public_key(file) for file in files or ()]
    return {verifier.name: verifier for verifier in verifiers}
