"""What the reports of whole runs share: side-cars, and tables of words."""
import json


def results(path):
    """What a stage says about a file it wrote; nothing if it is not there."""
    beside = path.with_name(path.name + ".prov.json")
    return json.loads(beside.read_text())["data"]["results"] if beside.exists() else {}


def frames(path):
    """The frames of an artifact with frames."""
    with open(path) as lines:
        next(lines)
        for line in lines:
            yield json.loads(line)


def table(rows):
    """Lines of aligned columns; the first row is the heading."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        yield "  ".join([row[0].ljust(widths[0])] + [cell.rjust(width) for cell, width in zip(row[1:], widths[1:])])


def number(value, digits=3):
    return "–" if value is None else f"{value:.{digits}f}"


def percent(part, whole):
    return f"{100 * part / whole:.1f} %" if whole else "–"
