"""Joins the figures of the fault suite's scenarios into build/faults/report.md and .json, and prints the table."""

import json
import pathlib

OUT = pathlib.Path(__file__).resolve().parents[2] / "build" / "faults"
# In the order in which a reader asks.
SCENARIOS = ["swarm", "kill", "sigterm", "half_open", "readers", "mutated", "cancel", "fairness", "overhead"]


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
            kept = {None: "", True: "yes", False: "**no**"}[row["kept"]]
            lines.append(f"| {row['what']} | {row['text']} | {row['promise']} | {kept} |")
        lines.append("")
    missing = [name for name in SCENARIOS if not (OUT / f"{name}.json").exists()]
    if missing:
        lines += [f"Not run: {', '.join(missing)}.", ""]
    text = "\n".join(lines)
    (OUT / "report.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
