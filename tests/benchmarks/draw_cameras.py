#!/usr/bin/env python3
"""Draws meshes of a workspace as its cameras see them, beside each other.

  draw_cameras.py --program build/release/bin/colmap_ext WORKSPACE PICTURE.png \\
      MESH... [--cameras 10] [--columns 5] [--width 300]

Cameras are taken evenly from all images by their names. Each row of cameras
stands once for each mesh, in the order of the meshes. Needs Pillow.
"""

import argparse
import pathlib
import subprocess
import tempfile

from PIL import Image

GAP = 4  # px


def draw(program, workspace, mesh, image, width, picture):
    subprocess.run([program, "mesh_viewer", "--workspace_path", workspace,
                    "--mesh_path", mesh, "--image_name", image, "--width",
                    str(2 * width), "--screenshot_path", picture],
                   check=True, capture_output=True)
    drawn = Image.open(picture).convert("RGB")
    return drawn.resize((width, drawn.height * width // drawn.width),
                        Image.Resampling.LANCZOS)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("workspace", type=pathlib.Path)
    parser.add_argument("picture", type=pathlib.Path)
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--cameras", type=int, default=10)
    parser.add_argument("--columns", type=int, default=5)
    parser.add_argument("--width", type=int, default=300)
    args = parser.parse_args()
    folder = args.workspace / "images"
    names = sorted(str(path.relative_to(folder))
                   for path in folder.rglob("*") if path.is_file())
    last = min(args.cameras, len(names)) - 1
    names = [names[i * (len(names) - 1) // max(last, 1)]
             for i in range(last + 1)]
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        for begin in range(0, len(names), args.columns):
            for mesh in args.meshes:
                rows.append([draw(args.program, args.workspace, mesh, name,
                                  args.width, pathlib.Path(scratch) / "a.png")
                             for name in names[begin:begin + args.columns]])
    heights = [max(picture.height for picture in row) + GAP for row in rows]
    sheet = Image.new("RGB", (args.columns * (args.width + GAP) - GAP,
                              sum(heights) - GAP), "white")
    for i, row in enumerate(rows):
        for k, picture in enumerate(row):
            sheet.paste(picture, (k * (args.width + GAP), sum(heights[:i])))
    sheet.quantize(32, dither=Image.Dither.NONE).save(args.picture,
                                                      optimize=True)


if __name__ == "__main__":
    main()
