#!/usr/bin/env python3
"""Usage: tests/benchmarks/plot_growth.py

Draws the growth of CPU time and memory, docs/images/growth.svg, from the tables
of docs/large-scenes.md: by copies of a scene, both axes logarithmic. Lines in
proportion are thin.
"""
import math
import pathlib

from merge_tables import read_tables

ROOT = pathlib.Path(__file__).resolve().parents[2]
# The titles of the tables begin so; color.
SERIES = {
    "wall, 12 images of 320 x 240: the mesher": ("mesher", "#1f77b4"),
    "wall, 12 images of 320 x 240: the refiner": ("refiner", "#d62728"),
}
SIZE = 300  # px, of a panel
MARGIN = 60  # px


def read_series():
    """[(name, color, copies, CPU s, peak MB)]"""
    text = (ROOT / "docs" / "large-scenes.md").read_text(encoding="utf-8")
    for title, head, rows in read_tables(text.splitlines()):
        for start, (name, color) in SERIES.items():
            if title.startswith(start):
                cells = next(row for row in rows if row[0] == "all")[1:-1]
                values = [tuple(map(float, cell.split(", "))) for cell in cells]
                yield (name, color, [int(x) for x in head[0][1:-1]],
                       [cpu for cpu, _ in values], [peak for _, peak in values])


def panel(left, title, curves):
    """An SVG group. curves: [(name, color, [x], [y])]"""
    last = max(x for _, _, xs, _ in curves for x in xs)
    low = min(y for *_, ys in curves for y in ys) / 1.5
    high = max(y for *_, ys in curves for y in ys) * 1.5

    def place(x, y):
        return (left + SIZE * math.log(x) / math.log(last),
                MARGIN + SIZE * (1 - math.log(y / low) / math.log(high / low)))

    def line(points, style):
        places = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        return f'<polyline points="{places}" fill="none" {style}/>'

    yield (f'<rect x="{left}" y="{MARGIN}" width="{SIZE}" height="{SIZE}" '
           'fill="none" stroke="#888"/>')
    yield f'<text x="{left + SIZE / 2}" y="{MARGIN - 16}">{title}</text>'
    x = 1
    while x <= last:
        at = place(x, low)
        yield f'<text x="{at[0]:.1f}" y="{at[1] + 20:.1f}">{x}</text>'
        x *= 4
    decade = 10 ** math.ceil(math.log10(low))
    while decade < high:
        at = place(1, decade)
        yield line([at, (at[0] + SIZE, at[1])], 'stroke="#ddd"')
        yield (f'<text x="{left - 6}" y="{at[1] + 4:.1f}" text-anchor="end">'
               f'{decade:g}</text>')
        decade *= 10
    for name, color, xs, ys in curves:
        top = min(last, high / ys[0])
        yield line([place(1, ys[0]), place(top, ys[0] * top)],
                   f'stroke="{color}" stroke-width="0.5" stroke-dasharray="4"')
        points = [place(*point) for point in zip(xs, ys)]
        yield line(points, f'stroke="{color}" stroke-width="2"')
        for x, y in points:
            yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{color}"/>'
        x, y = points[1]
        yield f'<text x="{x - 8:.1f}" y="{y - 12:.1f}" fill="{color}">{name}</text>'


def main():
    series = list(read_series())
    width = 2 * (SIZE + MARGIN) + MARGIN
    height = SIZE + 2 * MARGIN
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" '
             f'height="{height}" font-family="sans-serif" font-size="13" '
             'text-anchor="middle">',
             f'<rect width="{width}" height="{height}" fill="white"/>']
    for at, title in ((3, "CPU s, by copies"), (4, "peak MB, by copies")):
        left = MARGIN + (at - 3) * (SIZE + MARGIN)
        lines += panel(left, title, [(*each[:3], each[at]) for each in series])
    path = ROOT / "docs" / "images" / "growth.svg"
    path.write_text("\n".join([*lines, "</svg>", ""]), encoding="utf-8")


if __name__ == "__main__":
    main()
