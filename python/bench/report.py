"""A record as tables."""

from __future__ import annotations


def table(record: dict) -> str:
    """Markdown: millions a second by query and engine, and kdray's ratio to each."""
    # On a busy machine, what the others leave is chance.
    busy = bool(record["load"]) and record["load"][0] > record["cores"] / 2
    kind, seconds = ("cpu", "CPU seconds") if busy else ("seconds", "seconds")
    versions = ", ".join(f"{name} {version}" for name, version in record["versions"].items())
    load = record["load"][0] if record["load"] else float("nan")
    lines = [
        f"{record['date']}, {record['processor']}, {record['cores']} cores, load {load:.1f} before "
        f"the start; {versions}.",
        "",
        f"Best pass: millions in each of the {seconds}, and {seconds} of a build. In brackets how "
        "many times as fast kdray is. Differ: the largest share of answers that are not kdray's.",
    ]
    for scene in record["scenes"]:
        names = list(scene["rows"][0]["seconds"])
        lines += ["", f"**{scene['mesh']}**, {scene['triangles']:,} triangles", ""]
        lines += ["| query | " + " | ".join(names) + " | differ |", "|---" * (len(names) + 2) + "|"]
        for row in scene["rows"]:
            best = {name: min(spent) for name, spent in row[kind].items()}
            cells = []
            for name in names:
                speed = f"{best[name]:.3g} s"
                if row["query"] != "build":
                    speed = f"{row['count'][name] / best[name] / 1e6:.3g}"
                ratio = (best[name] / row["count"][name]) / (best["kdray"] / row["count"]["kdray"])
                cells.append(speed if name == "kdray" else f"{speed} ({ratio:.2g})")
            differ = max(row["differ"].values(), default=0.0)
            shown = "" if row["query"] == "build" else f"{differ:.2g}"
            lines.append(f"| {row['query']} | " + " | ".join(cells) + f" | {shown} |")
    return "\n".join(lines) + "\n"
