"""Puts the table of the newest record where a page says `TABLE`."""

import json
import sys
from pathlib import Path
from typing import Any

BENCH = Path(__file__).parents[1] / "bench"


def on_page_markdown(markdown: str, **_: Any) -> str:
    if "\nTABLE\n" not in markdown:
        return markdown
    records = sorted((BENCH / "records").glob("*.json"))
    if not records:
        raise SystemExit("docs: there is no record to show")
    return markdown.replace("\nTABLE\n", "\n" + table(json.loads(records[-1].read_text())) + "\n")


def table(record: dict[str, Any]) -> str:
    sys.path.insert(0, str(BENCH))
    try:
        import report

        return report.table(record)
    finally:
        sys.path.remove(str(BENCH))
