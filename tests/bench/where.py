"""Where the time of a step goes: plain SUMO, the same stepped over TraCI without an ego, with `ideal`, with `adaptive`.

    .ci/with-sumo python3 tests/bench/where.py SUMOCFG BEGIN_S END_S [ROUNDS]

Steps of 0.1 s. Prints a table with microseconds per step: wall, and the processor time of SUMO and of sumo-mfc, apart in
user and kernel. `perf` (Debian's linux-perf) tells the shares; the program is target/release/sumo-mfc.
"""

import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

STEP_S = 0.1
SUMO = ["--step-length", str(STEP_S), "--step-method.ballistic", "true", "--collision.mingap-factor", "0",
        "--no-step-log", "true", "--no-warnings", "true"]
KINDS = {
    "`sumo -c`": None,
    "stepped, no ego": ["--egos", "share:0"],
    "`ideal`": ["--controller", "ideal"],
    "`adaptive`": ["--controller", "adaptive"],
}
PARTS = [("sumo", False), ("sumo", True), ("sumo-mfc", False), ("sumo-mfc", True)]


def command(kind, config, end_s, folder):
    """What is measured."""
    if KINDS[kind] is None:
        return ["sumo", "-c", config, "--end", str(end_s), *SUMO]
    program = os.path.join("target", "release", "sumo-mfc")
    return [program, "run", config, "--end", str(end_s), "--step-length", str(STEP_S), "--quiet", "-o", folder, *KINDS[kind]]


def timed(kind, config, end_s, around=()):
    """Wall and processor time of a process and its children [s]."""
    with tempfile.TemporaryDirectory() as folder:
        before, begun = os.times(), time.perf_counter()
        line = [*around, *command(kind, config, end_s, os.path.join(folder, "out"))]
        subprocess.run(line, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wall_s, after = time.perf_counter() - begun, os.times()
    return wall_s, (after.children_user - before.children_user) + (after.children_system - before.children_system)


def shares(kind, config, end_s):
    """Shares of the samples by process, user and kernel apart."""
    with tempfile.TemporaryDirectory() as folder:
        data = os.path.join(folder, "perf.data")
        timed(kind, config, end_s, ["perf", "record", "-q", "-F", "2000", "-o", data, "--"])
        report = subprocess.run(["perf", "report", "-i", data, "--sort", "comm,dso", "-t", ",", "--percent-limit", "0"],
                                check=True, capture_output=True, text=True).stdout
    found = dict.fromkeys(PARTS, 0.0)
    for row in report.splitlines():
        cells = [cell.strip() for cell in row.split(",")]
        if row.startswith("#") or len(cells) < 3 or not cells[0].endswith("%"):
            continue
        # Threads of sumo-mfc have names of their own.
        process = "sumo" if cells[1] == "sumo" else "sumo-mfc"
        found[process, cells[2] == "[kernel.kallsyms]"] += float(cells[0].rstrip("%")) / 100
    return found


def main():
    config, begin_s, end_s = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
    rounds = int(sys.argv[4]) if len(sys.argv) > 4 else 5
    if shutil.which("perf") is None:
        sys.exit("perf is missing (Debian: linux-perf)")
    steps = (end_s - begin_s) / STEP_S
    us = lambda seconds: 1e6 * seconds / steps
    times = {kind: [] for kind in KINDS}
    for _ in range(rounds):
        for kind in KINDS:
            # Loading is not in it.
            loading, whole = timed(kind, config, begin_s + 1), timed(kind, config, end_s)
            times[kind].append([us(whole[i] - loading[i]) for i in (0, 1)])
    print("| µs per step | wall | processor | SUMO, user | SUMO, kernel | sumo-mfc, user | sumo-mfc, kernel |")
    print("|---|---|---|---|---|---|---|")
    for kind, taken in times.items():
        wall, processor = (statistics.median(t[i] for t in taken) for i in (0, 1))
        parts = [f"{share * processor:.0f}" for share in shares(kind, config, end_s).values()]
        print(f"| {kind} | {wall:.0f} | {processor:.0f} | " + " | ".join(parts) + " |")


if __name__ == "__main__":
    main()
