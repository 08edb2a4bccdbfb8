"""The paper's tables beside ours, as Markdown. None is printed as '-'."""

import published
from settings import ABLATIONS


def cell(value, digits):
    return "-" if value is None else f"{value:.{digits}f}"


def mean(values):
    """The mean of what is there, None of nothing."""
    values = [value for value in values if value is not None]
    return sum(values) / len(values) if values else None


def markdown(title, head, rows):
    lines = [f"### {title}", "", "| " + " | ".join(head) + " |",
             "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def table_1(results):
    """results: {setting: {ablation: {scan: [5 metrics, mm] or None}}}. Ours
    are means over the scans that were evaluated, whose number is told."""
    count = len(published.DTU_SCANS)
    rows = [(name, values, count)
            for name, values in published.TABLE_I_PEERS.items()]
    for ablation, title in ABLATIONS.items():
        rows.append((f"paper: {title}", published.TABLE_I[ablation], count))
        for setting, by_ablation in results.items():
            rows.append((f"ours, {setting}: {title}",
                         *_mean_over_scans(by_ablation.get(ablation, {}))))
    head = ["", *(name.replace("_", " ") for name in published.DTU_METRICS),
            "scans"]
    return markdown("Table I: DTU, mm", head, [
        [title, *(cell(value, 4) for value in values), str(count)]
        for title, values, count in rows])


def _mean_over_scans(by_scan):
    metrics = [values for values in by_scan.values() if values is not None]
    if not metrics:
        return [None] * len(published.DTU_METRICS), 0
    return [mean(column) for column in zip(*metrics)], len(metrics)


def avoided(before, after):
    """Per cent of the singular vertices; None where there are none."""
    if not before or after is None:
        return None
    return 100 * (1 - after / before)


def table_2(results):
    """results: {setting: {scan: (singular of the cut, after fixing)}}."""
    scans = published.DTU_SCANS
    rows = _rows_of_table_2("paper", published.TABLE_II)
    for setting, by_scan in results.items():
        counts = {scan: by_scan.get(scan, (None, None)) for scan in scans}
        rows += _rows_of_table_2(f"ours, {setting}", {
            scan: (*pair, avoided(*pair)) for scan, pair in counts.items()})
    return markdown("Table II: singular vertices",
                    ["", *map(str, scans), "mean"], rows)


def _rows_of_table_2(title, by_scan):
    rows = []
    for i, (label, digits) in enumerate(
            (("w/o fixing", 0), ("fixing", 0), ("% avoided", 1))):
        values = [by_scan[scan][i] for scan in published.DTU_SCANS]
        rows.append([f"{title}: {label}",
                     *(cell(value, digits) for value in values),
                     cell(mean(values), 1)])
    return rows


def table_3(results):
    """results: {setting: {ablation: {scene: (share below 2 cm, below 10 cm)
    or None}}}."""
    rows = [*published.TABLE_III_PEERS.items(),
            ("paper: all", published.TABLE_III)]
    for setting, by_ablation in results.items():
        rows += [(f"ours, {setting}: {title}", by_ablation.get(ablation, {}))
                 for ablation, title in ABLATIONS.items()]
    missing = [None] * len(published.EPFL_THRESHOLDS)
    head = ["", *(f"{scene}, {100 * threshold:.0f} cm"
                  for scene in published.TABLE_III
                  for threshold in published.EPFL_THRESHOLDS)]
    return markdown("Table III: EPFL, share of the true depths", head, [
        [title, *(cell(share, 3) for scene in published.TABLE_III
                  for share in by_scene.get(scene) or missing)]
        for title, by_scene in rows])
