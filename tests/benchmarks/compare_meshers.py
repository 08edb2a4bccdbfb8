#!/usr/bin/env python3
"""Compares delaunay_manifold_mesher with the meshers that others use.

Runs COLMAP's delaunay_mesher, ours and, where its programs are on the PATH,
OpenMVS' ReconstructMesh one after the other on copies of dense workspaces, and
prints Markdown tables: time, memory and what was written; accuracy where the
truth is known (truth/mesh.ply in the workspace), by mesh_evaluator; singular
vertices by rule. A figure that could not be measured is left out as '-'.

  compare_meshers.py --colmap build/release/bin/colmap [--threads 2] \\
      [--check mesh_check.py] [--no_thinning SECONDS] WORKSPACE...

--check     a script of one's own that prints `singular_vertices: N` and
            `nonmanifold_edges: N` for a mesh
--no_thinning  the first workspace also with max_proj_dist 0, given up after so
            many seconds
"""

import argparse
import json
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

OURS = "delaunay_manifold_mesher"
THEIRS = "delaunay_mesher"
SHORT = 20  # s


def run(command, seconds=None):
    """Runs a command; returns its output, wall s, CPU s and peak MB."""
    start = time.monotonic()
    with tempfile.TemporaryFile("w+") as log:
        process = subprocess.Popen(
            command, stdout=log, stderr=subprocess.STDOUT, text=True)
        if seconds:
            signal.signal(signal.SIGALRM, lambda *_: process.kill())
            signal.alarm(seconds)
        _, status, usage = os.wait4(process.pid, 0)
        signal.alarm(0)
        log.seek(0)
        output = log.read()
    return {
        "ok": status == 0,
        "output": output,
        "wall": time.monotonic() - start,
        "cpu": usage.ru_utime + usage.ru_stime,
        "peak": usage.ru_maxrss / 1024,
    }


def checked(command):
    """What run() returns; exits with the output of a command that fails."""
    command = [str(word) for word in command]
    result = run(command)
    if not result["ok"]:
        sys.exit(f"{' '.join(command)} failed:\n{result['output']}")
    return result


def mesh(args, command, workspace, output, options=(), seconds=None):
    prefix = ("DelaunayManifoldMeshing" if command == OURS
              else "DelaunayMeshing")
    line = [args.colmap, command, "--input_path", str(workspace),
            "--output_path", str(output),
            f"--{prefix}.num_threads", str(args.threads)]
    for name, value in options:
        line += [f"--{prefix}.{name}", str(value)]
    result = run(line, seconds)
    if result["ok"] and result["wall"] < SHORT:
        # The median of three, since other processes cost short runs most.
        runs = [result, run(line), run(line)]
        result = sorted(runs, key=lambda each: each["wall"])[1]
    if not result["ok"] and not seconds:
        sys.exit(f"{' '.join(line)} failed:\n{result['output']}")
    return result


def counted(output, name):
    """The number in the line of a report that starts with a name."""
    match = re.search(rf"^\s*{re.escape(name)}\s+([\d.]+)", output,
                      re.MULTILINE)
    return match.group(1) if match else "-"


def ply_counts(path):
    counts = {}
    with open(path, "rb") as file:
        for line in file:
            words = line.split()
            if words[:1] == [b"element"]:
                counts[words[1].decode()] = int(words[2])
            if words[:1] == [b"end_header"]:
                return counts
    return counts


def topology(args, path):
    if not args.check:
        return "-", "-"
    result = subprocess.run([sys.executable, args.check, str(path)],
                            capture_output=True, text=True)
    counts = tuple(counted(result.stdout, name)
                   for name in ("singular_vertices:", "nonmanifold_edges:"))
    if "-" in counts:
        sys.exit(f"{args.check} counted nothing:\n{result.stderr}")
    return counts


def evaluate(args, workspace, path):
    """Mean and median accuracy and completeness, 1e-3 units."""
    report = path.with_suffix(".json")
    checked([args.colmap, "mesh_evaluator", "--mesh_path", path,
             "--truth_path", workspace / "truth" / "mesh.ply",
             "--workspace_path", workspace, "--json_path", report])
    figures = json.loads(report.read_text())
    return [1000 * figures[side][kind]
            for side in ("accuracy", "completeness")
            for kind in ("mean", "median")]


def reconstruct_with_openmvs(args, workspace, output):
    """OpenMVS' mesher on the same points: what run() returns, for both of its
    programs together; not ok where they fail."""
    scene = output.with_suffix(".mvs")
    steps = [
        run(["InterfaceCOLMAP", "-i", str(workspace), "-o", str(scene),
             "--image-folder", str(workspace / "images")]),
        run(["ReconstructMesh", str(scene), "-o", str(output),
             "--max-threads", str(args.threads)]),
    ]
    return {"ok": all(step["ok"] for step in steps) and output.exists(),
            "output": "", "wall": sum(step["wall"] for step in steps),
            "cpu": sum(step["cpu"] for step in steps),
            "peak": max(step["peak"] for step in steps)}


def pixel_ratio(workspace):
    """How much larger a camera is than its image: delaunay_mesher measures
    max_proj_dist in the camera's pixels, ours in the image's."""
    with open(workspace / "sparse" / "cameras.bin", "rb") as file:
        width = struct.unpack("<QIiQQ", file.read(32))[3]
    image = next((workspace / "images").iterdir())
    data = image.read_bytes()
    if data[:4] == b"\x89PNG":
        return width / struct.unpack(">I", data[16:20])[0]
    at = 2
    while data[at + 1] not in (0xC0, 0xC1, 0xC2):
        at += 2 + struct.unpack(">H", data[at + 2:at + 4])[0]
    return width / struct.unpack(">H", data[at + 7:at + 9])[0]


def print_table(title, head, rows):
    print(f"\n### {title}\n")
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    sys.stdout.flush()


def compare(args, workspace, folder, seconds_unthinned):
    name = workspace.name
    ratio = pixel_ratio(workspace)
    same = [("max_proj_dist", round(20 / ratio, 4))]
    jobs = [("`delaunay_mesher`", THEIRS, []),
            ("ours, same distance", OURS, same)]
    if abs(ratio - 1) > 0.01:
        jobs.append(("ours, default", OURS, []))
    if seconds_unthinned:
        jobs += [("`delaunay_mesher`, every point", THEIRS,
                  [("max_proj_dist", 0)]),
                 ("ours, every point", OURS, [("max_proj_dist", 0)])]
    if (workspace / "truth").exists():
        jobs += [("ours, half a pixel, not calibrated", OURS,
                  [("half_pixel_correction", "full")]),
                 ("ours, no half pixel", OURS,
                  [("half_pixel_correction", "off")])]
    if shutil.which("InterfaceCOLMAP") and shutil.which("ReconstructMesh"):
        jobs.append(("OpenMVS `ReconstructMesh`", None, []))
    rows, scores, baseline = [], [], None
    for title, command, options in jobs:
        output = folder / f"{name}-{len(rows)}.ply"
        seconds = (seconds_unthinned if ("max_proj_dist", 0) in options
                   else None)
        if command:
            result = mesh(args, command, workspace, output, options, seconds)
        else:
            result = reconstruct_with_openmvs(args, workspace, output)
        if not result["ok"]:
            wall = f"> {seconds}" if seconds else "failed"
            rows.append([title, wall] + ["-"] * 7)
            continue
        baseline = baseline or result
        vertices = counted(result["output"], "vertices, after thinning"
                           if command == OURS else "Triangulation has")
        rows.append([
            title, f"{result['wall']:.1f}", f"{result['cpu']:.1f}",
            f"{result['peak']:.0f}",
            f"{baseline['wall'] / result['wall']:.1f}x, "
            f"{baseline['peak'] / result['peak']:.1f}x",
            vertices, ply_counts(output)["face"], *topology(args, output)])
        if (workspace / "truth" / "mesh.ply").exists():
            scores.append([title] + [
                f"{score:.2f}" for score in evaluate(args, workspace, output)])
    print_table(f"{name}: {args.threads} threads",
                ["", "wall s", "CPU s", "peak MB", "faster, smaller",
                 "vertices in", "faces", "singular vertices",
                 "non-manifold edges"], rows)
    if scores:
        print_table(f"{name}: accuracy, 1e-3 units",
                    ["", "mean acc.", "median acc.", "mean compl.",
                     "median compl."], scores)


def compare_rules(args, workspaces, folder):
    rows = []
    for workspace in workspaces:
        for rule in ("paper", "energy"):
            output = folder / "rule.ply"
            report = mesh(args, OURS, workspace, output,
                          [("fixing_rule", rule)])["output"]
            raw = counted(report, "of the cut")
            fixed = counted(report, "after fixing")
            avoided = (f"{100 * (1 - int(fixed) / int(raw)):.1f} %"
                       if int(raw) else "-")
            rows.append([workspace.name, rule, raw, fixed, avoided,
                         counted(report, "after the split"),
                         counted(report, "cells relabeled"),
                         counted(report, "cells split"),
                         topology(args, output)[0]])
    print_table("Singular vertices (the paper's Table II)",
                ["", "rule", "of the cut", "after fixing", "avoided",
                 "after the split", "cells relabeled", "cells split",
                 "written, by an independent check"], rows)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--colmap", required=True)
    parser.add_argument("--check")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--no_thinning", type=int, metavar="SECONDS")
    parser.add_argument("workspaces", nargs="+", type=pathlib.Path)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        workspaces = []
        for workspace in args.workspaces:
            workspaces.append(folder / workspace.name)
            shutil.copytree(workspace, workspaces[-1])
        for workspace in workspaces:
            compare(args, workspace, folder,
                    args.no_thinning if workspace == workspaces[0] else None)
        compare_rules(args, workspaces, folder)


if __name__ == "__main__":
    main()
