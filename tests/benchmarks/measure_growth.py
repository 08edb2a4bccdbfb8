#!/usr/bin/env python3
"""How time and memory of every stage grow, as Markdown tables.

  measure_growth.py --program build/release/bin/colmap_ext \\
      --make_workspace build/release/tests/make_workspace \\
      [--points WORKSPACE] [--survey] [--images] [--pairs] [--pixels]
      [--faces] [--threads WORKSPACE]
  measure_growth.py --copies WORKSPACE SIDE FOLDER

--points  the mesher on 1/8, 1/4 and 1/2 of a workspace's points, on all, and on
          2 x 2 and 4 x 4 copies of it side by side, each with its own images
--survey  both commands on 1, 2 x 2, 4 x 4 and 8 x 8 copies of a rendered wall
          side by side, each seen by 12 images of its own, and from the side by
          its neighbors'; --sides N leaves those out that are larger
--copies  makes a workspace of SIDE x SIDE copies, and nothing else
--images  the refiner on a rendered statue seen by 6, 12, 24 and 48 images
--pairs   the same with 48 images, where each has 2 to 16 partners
--pixels  the same with 12 images of 1/4 to 4 times the pixels
--faces   the same with faces of 28 to 3.5 pixels
--threads all commands by the number of threads (--thread_counts; the refiner
          on --backend); from the first and the last follow, by Amdahl's law, the
          times with 8 and 32 cores and the serial part

Times are CPU seconds of one thread, and of --threads wall seconds. The memory
of a stage is its peak. An exponent is that of the power law through the values
(least squares of logarithms); stages that never take 0.1 s have none.
"""

import argparse
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile

from compare_meshers import checked, print_table

MIN_TIME = 0.05  # s, of a run that counts for an exponent


class Cloud:
    """fused.ply and fused.ply.vis as records."""

    def __init__(self, workspace):
        ply = (workspace / "fused.ply").read_bytes()
        end = ply.index(b"end_header\n") + len(b"end_header\n")
        self.header = ply[:end].decode()
        self.count = int(re.search(r"element vertex (\d+)",
                                   self.header).group(1))
        size = (len(ply) - end) // self.count
        self.rows = [ply[end + i * size:end + (i + 1) * size]
                     for i in range(self.count)]
        vis = (workspace / "fused.ply.vis").read_bytes()
        words = memoryview(vis)[8:].cast("I")
        self.views, at = [], 0
        for _ in range(self.count):
            self.views.append(words[at + 1:at + 1 + words[at]].tolist())
            at += 1 + words[at]

    def write(self, folder, rows, views):
        with Writer(self, folder, len(rows)) as writer:
            writer.add(rows, views)


class Writer:
    """Writes fused.ply and fused.ply.vis piece by piece."""

    def __init__(self, cloud, folder, count):
        self.ply = open(folder / "fused.ply", "wb")
        self.vis = open(folder / "fused.ply.vis", "wb")
        header = cloud.header.replace(f"element vertex {cloud.count}",
                                      f"element vertex {count}")
        self.ply.write(header.encode())
        self.vis.write(struct.pack("<Q", count))

    def add(self, rows, views):
        self.ply.writelines(rows)
        self.vis.writelines(struct.pack(f"<{len(row) + 1}I", len(row), *row)
                            for row in views)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.ply.close()
        self.vis.close()


def read_images(workspace):
    """Of sparse/images.bin, in the file's order (fused.ply.vis counts them
    so): id, pose, camera, name."""
    data = (workspace / "sparse" / "images.bin").read_bytes()
    images, at = [], 8
    for _ in range(struct.unpack_from("<Q", data)[0]):
        image_id, *pose, camera = struct.unpack_from("<I7dI", data, at)
        end = data.index(b"\0", at + 64)
        images.append((image_id, pose, camera, data[at + 64:end].decode()))
        points = struct.unpack_from("<Q", data, end + 1)[0]
        at = end + 9 + 24 * points
    return images


def rotated(quaternion, vector):
    w, axis = quaternion[0], quaternion[1:]

    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0]]
    once = [2 * value for value in cross(axis, vector)]
    twice = cross(axis, once)
    return [vector[i] + w * once[i] + twice[i] for i in range(3)]


def write_part(workspace, cloud, folder, stride):
    folder.mkdir()
    for name in ("sparse", "images"):
        (folder / name).symlink_to((workspace / name).resolve())
    cloud.write(folder, cloud.rows[::stride], cloud.views[::stride])


def write_tiles(workspace, cloud, folder, side):
    """side x side copies next to each other, along the two longest axes."""
    points = [struct.unpack_from("<3f", row) for row in cloud.rows]
    ranges = []
    for axis in range(3):
        values = sorted(point[axis] for point in points)
        ranges.append(1.1 * (values[int(0.98 * len(values))]
                             - values[int(0.02 * len(values))]))
    axes = sorted(range(3), key=lambda axis: -ranges[axis])[:2]
    images = read_images(workspace)
    new_images = []
    for name in ("sparse", "images"):
        (folder / name).mkdir(parents=True)
    with Writer(cloud, folder, side * side * cloud.count) as writer:
        for tile in range(side * side):
            offset = [0.0] * 3
            offset[axes[0]] = ranges[axes[0]] * (tile // side)
            offset[axes[1]] = ranges[axes[1]] * (tile % side)
            shift = len(images) * tile
            writer.add((struct.pack("<3f", *(p + o for p, o in zip(
                point, offset))) + row[12:]
                for point, row in zip(points, cloud.rows)),
                ([view + shift for view in row] for row in cloud.views))
            for i, (_, pose, camera, name) in enumerate(images):
                moved = rotated(pose[:4], offset)
                new_images.append((shift + i + 1, pose[:4] + [
                    t - m for t, m in zip(pose[4:], moved)], camera,
                    f"{tile:03}_{name}", name))
    (folder / "sparse" / "cameras.bin").write_bytes(
        (workspace / "sparse" / "cameras.bin").read_bytes())
    with open(folder / "sparse" / "images.bin", "wb") as file:
        file.write(struct.pack("<Q", len(new_images)))
        for image_id, pose, camera, name, source in new_images:
            file.write(struct.pack("<I7dI", image_id, *pose, camera)
                       + name.encode() + b"\0" + struct.pack("<Q", 0))
            (folder / "images" / name).symlink_to(
                (workspace / "images" / source).resolve())
    (folder / "sparse" / "points3D.bin").write_bytes(struct.pack("<Q", 0))


def exponent(factors, values, least=MIN_TIME):
    """Of the power law through the values, or None."""
    pairs = [(math.log(f), math.log(v)) for f, v in zip(factors, values)
             if v > least]
    if len(pairs) < 3 or max(values) < 2 * least:
        return None
    mean_x = sum(x for x, _ in pairs) / len(pairs)
    mean_y = sum(y for _, y in pairs) / len(pairs)
    return (sum((x - mean_x) * (y - mean_y) for x, y in pairs)
            / sum((x - mean_x) ** 2 for x, _ in pairs))


def staged(command):
    """Runs a command; returns its output, and the CPU seconds and peak MB of
    each stage, in their order. The command ends a stage by a line."""
    command = [str(word) for word in command]
    process = subprocess.Popen(command, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True)
    proc = pathlib.Path("/proc") / str(process.pid)
    tick = os.sysconf("SC_CLK_TCK")
    output, cpu, peak, before = "", {}, {}, 0
    for line in process.stdout:
        output += line
        stage = re.match(r"(\S.*) \.\.\. [\d.]+ (s|min \d+ s)\s*$", line)
        if not stage:
            continue
        words = (proc / "stat").read_text().rsplit(")", 1)[1].split()
        now = (int(words[11]) + int(words[12])) / tick
        name = stage.group(1)
        cpu[name] = cpu.get(name, 0) + now - before
        before = now
        memory = re.search(r"VmHWM:\s+(\d+)", (proc / "status").read_text())
        peak[name] = max(peak.get(name, 0), int(memory.group(1)) / 1024)
        (proc / "clear_refs").write_text("5")  # the peak is the present memory
    if process.wait() != 0:
        sys.exit(f"{' '.join(command)} failed:\n{output}")
    return {"output": output, "cpu": cpu, "peak": peak}


def times(output):
    """Wall seconds of each stage, in the order of the report."""
    return {name: float(seconds) for name, seconds in
            re.findall(r"^\s\s(\S.*?)\s+([\d.]+) s$", output, re.MULTILINE)}


def count_of(output, name):
    found = re.findall(rf"^\s*{name}\s+(\d+)$", output, re.MULTILINE)
    return int(found[-1]) if found else 0


def table(title, heads, factors, results, count):
    """results: what staged() returns; count: the report's line that is
    counted."""
    stages = {stage: None for result in results for stage in result["cpu"]}
    all_cpu = [sum(result["cpu"].values()) for result in results]
    all_peaks = [max(result["peak"].values()) for result in results]

    def row(name, values, digits, power):
        return [name, *(f"{value:.{digits}f}" for value in values),
                "" if power is None else f"{power:.2f}"]

    def cells(name, cpu, peaks):
        seconds, megabytes = exponent(factors, cpu), exponent(factors, peaks, 1)
        return [name, *(f"{s:.2f}, {m:.0f}" for s, m in zip(cpu, peaks)),
                "" if seconds is None else f"{seconds:.2f}, {megabytes:.2f}"]
    counts = [count_of(result["output"], count) for result in results]
    rows = [row(count, counts, 0, exponent(factors, counts))]
    rows += [cells(stage, [result["cpu"].get(stage, 0) for result in results],
                   [result["peak"].get(stage, 0) for result in results])
             for stage in stages]
    rows.append(cells("all", all_cpu, all_peaks))
    print_table(title, ["CPU s, peak MB", *map(str, heads), "exponents"], rows)


def mesh(args, workspace, options=("--num_threads", 1)):
    return staged([args.program, "delaunay_manifold_mesher",
                   "--workspace_path", workspace, *options])


def refine(args, workspace, **options):
    options = {"backend": "cpu", "refine_cameras": "none"} | options
    return staged([args.program, "facetwise_refiner", "--workspace_path",
                   workspace, "--num_threads", 1,
                   *(word for name, value in options.items() for word in
                     (f"--FacetwiseRefinement.{name}", value))])


def render(args, folder, images, width, scene="statue"):
    checked([args.make_workspace, "--output_path", folder, "--scene", scene,
             "--num_images", images, "--width", width,
             "--height", width * 3 // 4])
    mesh(args, folder)
    return folder


def measure_points(args, folder):
    cloud = Cloud(args.points)
    results = []
    sizes = ["1/8", "1/4", "1/2", "1", "4", "16"]
    factors = [1 / 8, 1 / 4, 1 / 2, 1, 4, 16]
    for size, factor in zip(sizes, factors):
        workspace = folder / f"points-{factor}"
        if factor <= 1:
            write_part(args.points, cloud, workspace, round(1 / factor))
        else:
            write_tiles(args.points, cloud, workspace, round(factor ** 0.5))
        results.append(mesh(args, workspace))
    vertices = [count_of(result["output"], "vertices, after thinning")
                for result in results]
    table(f"{args.points.name}: the mesher by its points; exponents by the"
          " vertices", sizes, vertices, results, "vertices, after thinning")


def measure_survey(args, folder):
    wall = render(args, folder / "survey", 12, 320, "wall")
    cloud = Cloud(wall)
    sides = [side for side in (1, 2, 4, 8) if side <= args.sides]
    meshed, refined = [], []
    for side in sides:
        workspace = folder / f"survey-{side}"
        write_tiles(wall, cloud, workspace, side)
        meshed.append(mesh(args, workspace))
        refined.append(refine(args, workspace, iterations=2,
                              refine_cameras="poses"))
    copies = [side * side for side in sides]
    table("wall, 12 images of 320 x 240: the mesher by its copies", copies,
          copies, meshed, "vertices, after thinning")
    table("wall, 12 images of 320 x 240: the refiner by its copies", copies,
          copies, refined, "faces")


def measure_images(args, folder):
    counts = [6, 12, 24, 48]
    results = [refine(args, render(args, folder / f"images-{count}", count,
                                   320)) for count in counts]
    table("statue, 320 x 240: the refiner by its images", counts, counts,
          results, "faces")


def measure_pairs(args, folder):
    counts = [2, 4, 8, 16]
    workspace = render(args, folder / "pairs", 48, 320)
    results = [refine(args, workspace, pairs_per_image=count)
               for count in counts]
    table("statue, 48 images of 320 x 240: the refiner by the partners of each",
          counts, counts, results, "faces")


def measure_pixels(args, folder):
    widths = [160, 320, 640, 1280]
    results = [refine(args, render(args, folder / f"pixels-{width}", 12,
                                   width)) for width in widths]
    table("statue, 12 images: the refiner by its pixels",
          [f"{width} x {width * 3 // 4}" for width in widths],
          [width * width for width in widths], results, "faces")


def measure_faces(args, folder):
    areas = [28, 14, 7, 3.5]
    workspace = render(args, folder / "faces", 12, 640)
    results = [refine(args, workspace, max_face_area=area)
               for area in areas]
    table("statue, 12 images of 640 x 480: the refiner by its faces",
          [f"{area} px²" for area in areas],
          [count_of(result["output"], "faces") for result in results], results,
          "faces")


def amdahl(counts, seconds, cores):
    """Wall seconds with so many cores, by those with the first and the last
    of the counts."""
    ratio = counts[-1] / counts[0]
    serial = (ratio * seconds[-1] - seconds[0]) / (ratio - 1)
    serial = min(max(serial, 0), seconds[0])
    return serial + (seconds[0] - serial) * counts[0] / cores


def measure_threads(args, folder):
    workspace = folder / "threads"
    write_part(args.threads, Cloud(args.threads), workspace, 1)

    def run_mesher(count):
        return mesh(args, workspace, ["--num_threads", count])

    def run_refiner(count):
        return checked([args.program, "facetwise_refiner", "--workspace_path",
                        workspace, "--FacetwiseRefinement.backend",
                        args.backend, "--num_threads", count])

    plan = folder / "plan"

    def run_planner(count):
        shutil.rmtree(plan, ignore_errors=True)
        return checked([args.program, "mesh_planner", "--workspace_path",
                        workspace, "--output_path", plan, "--num_tiles", 2,
                        "--num_threads", count])

    def run_tile(count, tile=0):
        for done in plan.glob(f"tile{tile:05}.cut*"):
            done.unlink()
        return checked([args.program, "delaunay_manifold_mesher",
                        "--plan_path", plan, "--tile", tile,
                        "--num_threads", count])

    def run_merger(count):
        run_tile(count, 1)
        return checked([args.program, "mesh_merger", "--plan_path", plan,
                        "--output_path", folder / "merged.ply",
                        "--num_threads", count])
    counts = args.thread_counts
    for name, run_with in (("mesher", run_mesher), ("planner", run_planner),
                           ("mesher of one of two tiles", run_tile),
                           ("merger", run_merger), ("refiner", run_refiner)):
        # The least of some runs, since other processes only add to them.
        by_count = []
        for count in counts:
            runs = [times(run_with(count)["output"])
                    for _ in range(args.repeats)]
            by_count.append({stage: min(run[stage] for run in runs)
                             for stage in runs[0]})
        rows = []
        for stage in by_count[0]:
            if stage != "all":
                seconds = [result.get(stage, 0) for result in by_count]
                rows.append([stage, *seconds, *(
                    amdahl(counts, seconds, cores)
                    for cores in (8, 32, math.inf))])
        rows.append(["all", *map(sum, list(zip(*rows))[1:])])
        rows.append(["share", *(value / rows[-1][1] for value in rows[-1][1:])])
        print_table(f"{args.threads.name}: the {name} by its threads, s",
                    ["", *map(str, counts), "8 cores", "32 cores", "serial"],
                    [[row[0], *(f"{value:.2f}" for value in row[1:])]
                     for row in rows])


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--program")
    parser.add_argument("--make_workspace")
    parser.add_argument("--points", type=pathlib.Path, metavar="WORKSPACE")
    parser.add_argument("--threads", type=pathlib.Path, metavar="WORKSPACE")
    parser.add_argument("--copies", nargs=3,
                        metavar=("WORKSPACE", "SIDE", "FOLDER"))
    parser.add_argument("--sides", type=int, default=8)
    parser.add_argument("--repeats", type=int, default=1)
    parser.add_argument("--thread_counts", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--backend", default="cpu")
    for name in ("survey", "images", "pairs", "pixels", "faces"):
        parser.add_argument(f"--{name}", action="store_true")
    args = parser.parse_args()
    if args.copies:
        workspace, side, folder = args.copies
        write_tiles(pathlib.Path(workspace), Cloud(pathlib.Path(workspace)),
                    pathlib.Path(folder), int(side))
        return
    with tempfile.TemporaryDirectory() as temporary:
        for name, measure in (("points", measure_points),
                              ("survey", measure_survey),
                              ("threads", measure_threads),
                              ("images", measure_images),
                              ("pairs", measure_pairs),
                              ("pixels", measure_pixels),
                              ("faces", measure_faces)):
            if getattr(args, name):
                measure(args, pathlib.Path(temporary))


if __name__ == "__main__":
    main()
