#!/usr/bin/env python3
"""Usage: tests/benchmarks/summarize.py [--check]

Writes what repeats figures of the tables of docs/results.md: its own table "Side
by side", and the table and the text below it in README.md, between their marks.
With --check nothing is written, and it fails if anything would change.
"""
import pathlib
import re
import sys
from decimal import ROUND_HALF_UP, Decimal

from merge_tables import read_tables

ROOT = pathlib.Path(__file__).resolve().parents[2]
README = ROOT / "README.md"
RESULTS = ROOT / "docs" / "results.md"
COMMANDS = ("`delaunay_mesher`", "`ReconstructMesh`", "`delaunay_manifold_mesher`",
            "`RefineMesh`", "`facetwise_refiner`")
# Where our meshers' rows are: "ours, default" where the distance differs.
OURS = ("ours, default", "ours, same distance")


class Figures:
    """The figures of the tables: title, first cells of the row, column."""

    def __init__(self, text):
        # "2026-11-27, 2 cores of ..."
        self.machine = re.search(r"<!-- meshers: .*?-->\s*(.*)\.\n", text)[1]
        self.tables = {}
        for title, head, rows in read_tables(text.splitlines()):
            if head:
                self.tables.setdefault(title, []).append((head[0], rows))

    def find(self, title, column, *names):
        """The cell of the first row that begins with the names; "" if there is
        none, or nothing was measured."""
        for head, rows in self.tables.get(title, []):
            for row in rows:
                if column in head and tuple(row[:len(names)]) == names:
                    return "" if row[head.index(column)] == "-" else (
                        row[head.index(column)])
        return ""


def rounded(figure, unit):
    """"0.246", "0.01" -> "0.25"; an empty cell stays empty."""
    return figure and str(Decimal(figure).quantize(Decimal(unit), ROUND_HALF_UP))


def side_by_side(figures, scene, command):
    """[accuracy, CPU s, wall s, peak MB, singular vertices] of a command."""
    costs = ("CPU s", "wall s", "peak MB")
    accuracy = ("mean acc.", "median acc.")

    def first(column, *places):
        """From the first (title, name of the row) that has it."""
        found = (figures.find(title, column, scene, name) for title, name in places)
        return next(filter(None, found), "")

    if command in ("`ReconstructMesh`", "`RefineMesh`"):
        return [first(column, ("OpenMVS 2.3", command))
                for column in ("mean, median acc.", *costs)] + [""]
    if command == "`facetwise_refiner`":
        places = [("refinement, 1e-3 units", "default"), ("refinement", "default"),
                  ("photographs", command)]
    elif command == "`delaunay_manifold_mesher`":
        places = [*(("2 threads", name) for name in OURS),
                  ("refinement, 1e-3 units", "input")]
    else:
        places = [("2 threads", command), ("accuracy, 1e-3 units", command)]
    errors = [first(column, *places) for column in accuracy]
    return [", ".join(filter(None, errors)),
            *(first(column, *places) for column in (*costs, "singular vertices"))]


def side_by_side_table(figures):
    yield ("| scene | command | mean, median acc. | CPU s | wall s | peak MB | "
           "singular vertices |")
    yield "|---|---|---|---|---|---|---|"
    for scene in ("bunny", "fountain"):
        for command in COMMANDS:
            cells = side_by_side(figures, scene, command)
            yield f"| `{scene}` | {command} | {' | '.join(cells)} |"


def readme_table(figures):
    yield ("| | `bunny`: mean error | `bunny`: median error | `bunny`: CPU s | "
           "`fountain`: CPU s | `fountain`: peak MB | `fountain`: singular vertices |")
    yield "|---|---|---|---|---|---|---|"
    for command in COMMANDS:
        bunny = side_by_side(figures, "bunny", command)
        fountain = side_by_side(figures, "fountain", command)
        cells = [rounded(x, "0.01") for x in bunny[0].split(", ")]
        cells += [rounded(x, "1") for x in (bunny[1], fountain[1], fountain[3])]
        cells.append(fountain[4])
        if command in ("`ReconstructMesh`", "`RefineMesh`"):
            name = f"OpenMVS 2.3 {command}"
            cells[2:] = [cell and cell + r"\*" for cell in cells[2:]]
        elif command == "`delaunay_mesher`":
            name = f"COLMAP 3.8 {command}"
        else:
            name = command
            cells = [cell and f"**{cell}**" for cell in cells]
        yield f"| {name} | {' | '.join(cells)} |"


def readme_text(figures):
    def of_meshers(name, column):
        return figures.find("2 threads", column, "fountain", name)

    ours, same, theirs = (f"{int(of_meshers(name, 'vertices in')):,}"
                          for name in (*OURS, "`delaunay_mesher`"))
    faster = of_meshers(OURS[1], "faster, smaller").split("x")[0]
    posed = figures.find("poses that are off, 1e-3 units", "`auto`", "bunny", "0.5")
    errors = " and ".join(rounded(x, "0.01") for x in posed.split(", "))
    yield (f"{figures.machine}, two threads, no graphics card. Both meshers thin the "
           f"points: by default ours keeps {ours} vertices of")
    yield (f"`fountain`, `delaunay_mesher` {theirs}. With the same `max_proj_dist` ours "
           f"keeps {same} and is {faster} times")
    yield ("as fast. If the poses of `bunny` are off by half a pixel, the errors of the "
           f"refined mesh are {errors}.")


def fill(text, name, lines):
    """The text with the lines between the marks of a name."""
    pattern = rf"(<!-- {name}: [^\n]*-->\n).*?(<!-- end of {name} -->)"
    block = "\n" + "\n".join(lines) + "\n\n"
    return re.sub(pattern, lambda marks: marks[1] + block + marks[2], text,
                  flags=re.DOTALL)


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit(__doc__)
    results = RESULTS.read_text(encoding="utf-8")
    figures = Figures(results)
    readme = README.read_text(encoding="utf-8")
    new_texts = {
        RESULTS: fill(results, "side_by_side", side_by_side_table(figures)),
        README: fill(readme, "figures", [*readme_table(figures), "",
                                         *readme_text(figures)])}
    for path, text in new_texts.items():
        if text != path.read_text(encoding="utf-8"):
            if sys.argv[1:] == ["--check"]:
                sys.exit(f"{path.relative_to(ROOT)}: its figures are not those of "
                         "docs/results.md. Run tests/benchmarks/summarize.py.")
            path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
