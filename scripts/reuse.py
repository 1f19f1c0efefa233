#!/usr/bin/python3
"""Grades cells of the matrix of reuse (docs/reuse.md): one scenario, with robot, lidar and estimator exchanged.

A cell is written as a scenario of its own and driven by `grade`. The table goes to OUTPUT/reuse.md. The exit code is zero
only if every cell keeps its limits.
"""
import argparse
import concurrent.futures
import itertools
import json
import os
import pathlib
import subprocess
import sys

import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent
COLUMNS = ("online_ate_m", "ate_m", "yaw_rms_rad", "map_iou", "wall_m", "times_lost")


def cells(matrix):
    return list(itertools.product(matrix["robots"], matrix["lidars"], matrix["estimators"]))


def scenario_of(matrix, config, cell):
    """The base scenario with the three keys of the cell, and what is demanded of it."""
    robot, lidar, estimator = cell
    scenario = dict(matrix["scenario"], robot=robot, lidar=lidar, estimator=estimator)
    for key in ("world", "tour"):
        scenario[key] = str(config / scenario[key])
    needs = dict(matrix["estimators"][estimator])
    scenario["limits"] = dict(matrix["limits"], **matrix["lidars"][lidar])
    scenario["limits"]["online_ate_m"] = needs.pop("online_ate_m")[lidar]
    return dict(scenario, **needs)


def grade(options, matrix, cell):
    """The run of the cell as `grade` reports it, or why there is none."""
    name = "-".join(cell)
    path = options.output / (name + ".yaml")
    path.write_text(yaml.safe_dump(scenario_of(matrix, options.config, cell)))
    finished = subprocess.run([options.grade, str(path), str(options.seed), "--config", str(options.config), "--output",
                               str(options.output)], capture_output=True, text=True, check=False)
    report = options.output / (name + ".json")
    if not report.exists():
        return {"figures": {}, "broken": [finished.stderr.strip() or "no report"]}
    return json.loads(report.read_text())["runs"][0]


def row_of(cell, run):
    figures = ["%.3g" % run["figures"][name] if run["figures"].get(name) is not None else "-" for name in COLUMNS]
    return " | ".join(("", *cell, *figures, "; ".join(run["broken"]) or "kept", "")).strip()


def options_from(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cells", metavar="CELL", nargs="*", help="ROBOT-LIDAR-ESTIMATOR; all without any")
    parser.add_argument("--config", type=pathlib.Path, default=ROOT / "config")
    parser.add_argument("--grade", default=str(ROOT / "devel/lib/ramscout_bringup/grade"), help="the program")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "results/reuse")
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args(arguments)


def main(arguments):
    options = options_from(arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    matrix = yaml.safe_load((options.config / "reuse.yaml").read_text())
    known = {"-".join(cell): cell for cell in cells(matrix)}
    unknown = set(options.cells) - set(known)
    if unknown:
        sys.exit("there is no cell %s; known are: %s" % (", ".join(sorted(unknown)), ", ".join(known)))
    chosen = [known[name] for name in options.cells or known]
    header = " | ".join(("", "robot", "lidar", "estimator", *COLUMNS, "limits", "")).strip()
    table = [header, "|" + "---|" * (len(COLUMNS) + 4)]
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for cell, run in zip(chosen, pool.map(lambda cell: grade(options, matrix, cell), chosen)):
            table.append(row_of(cell, run))
            print(table[-1], flush=True)
            failed += bool(run["broken"])
    (options.output / "reuse.md").write_text("\n".join(table) + "\n")
    print("%d of %d cells keep their limits" % (len(chosen) - failed, len(chosen)))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
