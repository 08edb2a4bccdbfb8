#!/usr/bin/env python3
"""Usage: COMMAND | tests/benchmarks/merge_tables.py REGEX

Shortens what the comparisons print: keeps the rows whose first cell matches
REGEX, and joins the tables "### SCENE: KIND" of one kind into "### KIND", with
the scene before each row.
"""
import re
import sys


def read_tables(lines):
    """(title, [head, rule], rows) of each table; a row is a list of cells."""
    tables = []
    for line in lines:
        if line.startswith("#"):
            tables.append((line.lstrip("# ").rstrip(), [], []))
        elif line.startswith("|") and tables:
            _, head, rows = tables[-1]
            cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
            (head if len(head) < 2 else rows).append(cells)
    return tables


def merge(tables, pattern):
    kinds = {}
    for title, head, rows in tables:
        scene, found, kind = title.partition(": ")
        key = (kind if found else title, tuple(head[0]))
        kept = [row for row in rows if re.search(pattern, row[0])]
        if kept:
            kinds.setdefault(key, []).append((scene, head, kept))
    for (kind, _), group in kinds.items():
        is_joined = len(group) > 1
        scene, head, _ = group[0]
        yield kind if is_joined or kind == scene else f"{scene}: {kind}", [
            *([""] * is_joined + cells for cells in head[:1]),
            ["---"] * (len(head[0]) + is_joined),
            *([scene] * is_joined + row for scene, _, rows in group for row in rows)]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for title, rows in merge(read_tables(sys.stdin), sys.argv[1]):
        print(f"\n### {title}\n")
        for row in rows:
            print("| " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
