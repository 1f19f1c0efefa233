#!/usr/bin/python3
"""benchmark_logs.py LOGS OUTPUT: runs the offline stack on every CARMEN log of a folder and prints one table.

A log NAME.clf (also .log, .xz, .gz) is evaluated by NAME.relations (or NAME.*.relations, also packed) beside it. Each run is
pinned to one core; its CPU seconds are those of the whole process, reading and drawing included. The table is also written
to OUTPUT/table.md and OUTPUT/table.json.
"""
import json
import subprocess
import sys
from pathlib import Path

LOG_ENDINGS = (".clf", ".clf.xz", ".clf.gz", ".log", ".log.xz", ".log.gz")
COLUMNS = ("log", "trajectory", "relations", "m, mean ± std", "Cartographer's m", "deg, mean ± std",
           "> 30 s apart: m", "> 30 s apart: deg", "CPU s", "× real time", "MB")
TRAJECTORIES = {"trajectory": "final", "trajectory_filter": "filter", "trajectory_online": "as known then"}


def logs_in(folder):
    for path in sorted(folder.iterdir()):
        relations = sorted(folder.glob(path.name.split(".")[0] + ".*relations*"))
        if path.name.endswith(LOG_ENDINGS) and relations:
            yield path, relations[0]


def evaluate(trajectory, relations):
    table = trajectory.with_suffix(".errors.json")
    subprocess.run(["rosrun", "ramscout_bringup", "evaluate", str(trajectory), "--relations", str(relations),
                    "--json", str(table)], check=True, stdout=subprocess.DEVNULL)
    return {row["name"]: row for row in json.loads(table.read_text())}


def row_of(log, trajectory, errors, timing):
    def mean_and_std(name, digits):
        return "%.*f ± %.*f" % (digits, errors[name]["mean"], digits, errors[name]["std"])
    return (log, trajectory, str(errors["all pairs: translation"]["count"]),
            mean_and_std("all pairs: translation", 4), "%.4f" % errors["all pairs: translation, Cartographer's"]["mean"],
            mean_and_std("all pairs: rotation", 3), "%.4f" % errors["pairs > 30 s apart: translation"]["mean"],
            "%.3f" % errors["pairs > 30 s apart: rotation"]["mean"], "%.1f" % timing["cpu_s"],
            "%.0f" % timing["times_real_time"], "%.0f" % timing["peak_memory_mb"])


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    logs, output = Path(sys.argv[1]), Path(sys.argv[2])
    output.mkdir(parents=True, exist_ok=True)
    rows, details = [], []
    for log, relations in logs_in(logs):
        name = log.name.split(".")[0]
        folder = output / name
        print("running " + name, flush=True)
        subprocess.run(["taskset", "-c", "0", "rosrun", "ramscout_bringup", "run_bag", str(log), "--output", str(folder)],
                       check=True, stdout=subprocess.DEVNULL)
        timing = json.loads((folder / "timing.json").read_text())
        for trajectory, label in TRAJECTORIES.items():
            errors = evaluate(folder / (trajectory + ".tum"), relations)
            rows.append(row_of(name, label, errors, timing))
            details.append({"log": name, "trajectory": trajectory, "errors": list(errors.values()), "timing": timing})
    if not rows:
        sys.exit("no log with relations in " + str(logs))
    lines = ["| " + " | ".join(cells) + " |" for cells in (COLUMNS, ("---",) * len(COLUMNS), *rows)]
    (output / "table.md").write_text("\n".join(lines) + "\n")
    (output / "table.json").write_text(json.dumps(details, indent=2) + "\n")
    print("\n".join(lines))


main()
