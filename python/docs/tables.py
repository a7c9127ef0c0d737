"""Puts the tables of the newest records where a page says `TABLE`."""

import json
import sys
from pathlib import Path
from typing import Any

BENCH = Path(__file__).parents[1] / "bench"


def on_page_markdown(markdown: str, **_: Any) -> str:
    if "\nTABLE\n" not in markdown:
        return markdown
    records = [json.loads(path.read_text()) for path in sorted((BENCH / "records").glob("*.json"))]
    if not records:
        raise SystemExit("docs: there is no record to show")
    newest = max(record["date"] for record in records)
    tables = [table(record) for record in records if record["date"] == newest]
    return markdown.replace("\nTABLE\n", "\n" + "\n\n".join(tables) + "\n")


def table(record: dict[str, Any]) -> str:
    sys.path.insert(0, str(BENCH))
    try:
        import report

        return report.table(record)
    finally:
        sys.path.remove(str(BENCH))
