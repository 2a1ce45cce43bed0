"""docs/error-codes.md from the table of errors: `python -m service.error_page > docs/error-codes.md`."""

from service.errors import ANSWERS

_HEAD = """# Error codes

Every error is `application/problem+json` (RFC 9457) with `code`, `detail`, `what_to_do`, and where they apply
`measured`, `limit`, `leads_onwards` and `verdicts`. A code keeps its meaning. This page is generated from
`service/errors.py` by `python -m service.error_page`; a test compares the two.

| code | HTTP status | what to do |
|---|---|---|
"""


def page() -> str:
    """The page as Markdown."""
    return _HEAD + "".join(f"| `{code}` | {one.status} | {one.what_to_do} |\n" for code, one in ANSWERS.items())


if __name__ == "__main__":
    print(page(), end="")
