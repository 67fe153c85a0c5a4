"""Joins the figures of the fault suite's scenarios into build/faults/report.md and .json, and prints the table."""

import json
import pathlib
import re

OUT = pathlib.Path(__file__).resolve().parents[2] / "build" / "faults"
# In the order of a reader's questions.
SCENARIOS = ["swarm", "kill", "sigterm", "half_open", "readers", "attacks", "mutated", "cancel", "fairness", "tenants",
             "overhead", "gateway", "stores"]


def in_bold(kept):
    """Returns the word, if the promise was not kept."""
    return re.sub("^(no|missed)", r"**\1**", kept)


def main():
    reports = []
    for name in SCENARIOS:
        path = OUT / f"{name}.json"
        if path.exists():
            reports.append(json.loads(path.read_text()))
    (OUT / "report.json").write_text(json.dumps(reports, indent=1) + "\n")
    lines = ["# Fault suite", ""]
    for report in reports:
        lines += [f"## {report['scenario'].replace('_', '-')}", ""]
        lines += [f"{report['seconds']:.0f} s of load; seed {report['seed']}; {report['took']:.0f} s in all.", ""]
        lines += ["| figure | value | promised | kept |", "|---|---|---|---|"]
        for row in report["figures"]:
            lines.append(f"| {row['what']} | {row['text']} | {row['promise']} | {in_bold(row['kept'])} |")
        lines.append("")
    every = [row["kept"] for report in reports for row in report["figures"]]
    kept, missed, failed = (sum(k.startswith(word) for k in every) for word in ("yes", "missed", "no"))
    lines += [f"Of {kept + missed + failed} promises {kept} were kept, {missed} missed, {failed} failed.", ""]
    missing = [name for name in SCENARIOS if not (OUT / f"{name}.json").exists()]
    if missing:
        lines += [f"Not run: {', '.join(missing)}.", ""]
    text = "\n".join(lines)
    (OUT / "report.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
