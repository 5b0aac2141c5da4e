"""The scoreboard: measures named metrics of the stages and compares them with their targets.

    python tools/peers/board.py score|bench STAGE|all [--seeds 1,2,3] [--json]

A stage's metrics stand in `tools/peers/<stage>.py` (hyphens as underscores), which has a `score(ctx)` (accuracy) or a
`bench(ctx)` (speed and memory) or both: generators of dictionaries, see README.md beside this file. Exit code 0 if
every target is met, 1 if one is missed or could not be measured, 2 for usage.
"""

import argparse
import importlib.util
import json
import math
import sys
import traceback
from pathlib import Path

from context import Context, Missing

HERE = Path(__file__).resolve().parent
OWN = {"board", "context", "test_board"}
BETTER = {"lower", "higher", "equal", None}
KEYS = {"metric", "value", "target", "better", "unit", "context", "reason"}


def stages():
    """Names of the stages that have metrics, sorted. What stages share stands in modules with a leading underscore."""
    found = (path.stem for path in HERE.glob("*.py"))
    return sorted(stem.replace("_", "-") for stem in found if stem not in OWN and not stem.startswith("_"))


def load(stage):
    """The module with a stage's metrics."""
    name = stage.replace("-", "_")
    spec = importlib.util.spec_from_file_location(name, HERE / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def passes(row):
    """Whether a metric meets its target; None if it is only reported."""
    value, target, better = row["value"], row["target"], row["better"]
    if better is None or target is None:
        return None
    if value is None:
        return False
    return {"lower": value <= target, "higher": value >= target, "equal": value == target}[better]


def judged(row, stage):
    """A row with every key there, checked, and with its verdict."""
    unknown = set(row) - KEYS
    if unknown or "metric" not in row:
        raise ValueError(f"a metric needs a name and has no keys {sorted(unknown)}: {row}")
    row = {"metric": "", "value": None, "target": None, "better": None, "unit": "", "pass": None, "context": {}} | row
    if row["better"] not in BETTER:
        raise ValueError(f"{row['metric']}: 'better' is {row['better']!r}, not one of lower, higher, equal, None")
    if not row["metric"].startswith(f"{stage}/"):
        row["metric"] = f"{stage}/{row['metric']}"
    row["value"] = plain(row["value"])
    if isinstance(row["value"], float) and not math.isfinite(row["value"]):
        row["value"], row["reason"] = None, row.get("reason", f"the value is {row['value']}")
    if row["value"] is None:
        row.setdefault("reason", "no reason was given")
    row["pass"] = passes(row)
    return row


def plain(value):
    """NumPy scalars and arrays as Python numbers and lists."""
    return value.tolist() if hasattr(value, "tolist") else value


def jsonable(value):
    """What JSON does not know: NumPy's values as plain ones, anything else as text."""
    return plain(value) if hasattr(value, "tolist") else str(value)


def failed(stage, kind, reason):
    """The row for metrics that could not be measured at all; it has a target, so it counts as failed."""
    return {"metric": f"{stage}/{kind}", "value": None, "target": "measured", "better": "equal", "reason": reason}


def measure(stage, kind, ctx):
    """Yields the judged rows of one stage. What goes wrong becomes a failed row, never a crash."""
    try:
        module = load(stage)
        if not hasattr(module, kind):
            return
        for row in getattr(module, kind)(ctx):
            yield judged(row, stage)
    except Missing as missing:
        yield judged(failed(stage, kind, str(missing)), stage)
    except Exception as error:  # a peer may raise anything
        traceback.print_exc(file=sys.stderr)
        yield judged(failed(stage, kind, f"{type(error).__name__}: {error}"), stage)


def shown(value):
    """A number for people: four significant digits. Tables inside the context are for `--json`."""
    if value is None:
        return "–"
    if isinstance(value, dict) or isinstance(value, list) and len(str(value)) > 60:
        return "…"
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    return f"{value:.4g}"


def cells(row):
    """A row of the table."""
    sign = {"lower": "≤ ", "higher": "≥ ", "equal": "= ", None: ""}[row["better"]]
    target = "" if row["target"] is None else sign + shown(row["target"])
    verdict = {True: "pass", False: "FAIL", None: "reported"}[row["pass"]]
    note = row.get("reason") or ", ".join(f"{key} {shown(value)}" for key, value in row["context"].items())
    return [row["metric"], shown(row["value"]), target, row["unit"], verdict, note]


def print_table(rows):
    """The rows aligned in columns; the last column may be long and is not padded."""
    table = [["metric", "value", "target", "unit", "", "context"], *map(cells, rows)]
    widths = [max(len(line[column]) for line in table) for column in range(5)]
    for line in table:
        print("  ".join([cell.ljust(width) for cell, width in zip(line, widths)] + line[5:]).rstrip())
    missed = sum(row["pass"] is False for row in rows)
    held = sum(row["pass"] is True for row in rows)
    print(f"\n{held} targets met, {missed} missed, {len(rows) - held - missed} values reported only")


def arguments(words):
    """The command line."""
    parser = argparse.ArgumentParser(prog="board", description=__doc__.splitlines()[0])
    parser.add_argument("kind", choices=["score", "bench"])
    parser.add_argument("stage", help="a stage, or 'all'; with metrics: " + ", ".join(stages()))
    parser.add_argument("--seeds", default="1,2,3", help="seeds of the synthetic takes [default: 1,2,3]")
    parser.add_argument("--json", action="store_true", help="one JSON object per metric")
    chosen = parser.parse_args(words)
    if chosen.stage != "all" and chosen.stage not in stages():
        parser.error(f"{chosen.stage} has no metrics; those that have: {', '.join(stages()) or 'none'}")
    try:
        chosen.seeds = [int(seed) for seed in chosen.seeds.split(",")]
    except ValueError:
        parser.error(f"--seeds takes whole numbers with commas between, not {chosen.seeds!r}")
    return chosen


def main(words=None):
    """Measures, prints, and returns the exit code."""
    chosen = arguments(words)
    rows = []
    with Context(chosen.seeds) as ctx:
        for stage in stages() if chosen.stage == "all" else [chosen.stage]:
            print(f"{chosen.kind} {stage} …", file=sys.stderr)
            for row in measure(stage, chosen.kind, ctx):
                rows.append(row)
                if chosen.json:
                    print(json.dumps(row, ensure_ascii=False, default=jsonable), flush=True)
    if not rows:
        print(f"board: no metric was measured: {chosen.stage} has no {chosen.kind}()", file=sys.stderr)
        return 1
    if not chosen.json:
        print_table(rows)
    return int(any(row["pass"] is False for row in rows))


if __name__ == "__main__":
    sys.exit(main())
