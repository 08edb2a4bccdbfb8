#!/usr/bin/env python3
"""Prints tables I, II and III of the paper beside ours.

  reproduce.py 1 2 --dtu DTU --work WORK --colmap build/release/bin/colmap
  reproduce.py 3 --epfl EPFL --work WORK --colmap build/release/bin/colmap

Makes what is missing under WORK: a COLMAP workspace for each scene with the
known cameras, its fused points (by a COLMAP with CUDA, or those of --fused),
the meshes, their evaluation. What cannot be computed is said and printed as
'-'. See README.md for the layout of the data.
"""

import argparse
import json
import pathlib
import shutil
import sys

import colmap_model
import dense
import dtu
import epfl
import evaluate
import meshes
import published
import settings
import tables
from cameras import DTU_PIXEL_CENTER, EPFL_PIXEL_CENTER
from colmap_tool import Colmap, CommandFailed

CAN_NOT = (CommandFailed, OSError, ImportError, ValueError)


def say(text):
    print(text, file=sys.stderr, flush=True)


def prepare(colmap, workspace, views, fused):
    """The workspace of a scene, up to its fused points. fused: a folder that
    has them, or None."""
    if not (workspace / "sparse" / "cameras.txt").exists():
        colmap_model.write_workspace(workspace, views)
    if fused and not dense.is_fused(workspace):
        dense.take_fused(workspace, fused)
    dense.make_dense(colmap, workspace, views)


def attempt(name, function, *arguments):
    """What a function returns; None if it fails for a reason that is said."""
    try:
        return function(*arguments)
    except CAN_NOT as error:
        say(f"{name}: {error}")
        return None


def measure(colmap, workspace, setting, ablation, evaluator):
    """{"singular": (of the cut, after fixing), "figures": [...] or None} of
    an ablation, computed once; None if it cannot be."""
    path = workspace / "results" / f"{setting}-{ablation}.json"
    can_evaluate = evaluate.EVALUATOR in colmap.commands
    if path.exists():
        result = json.loads(path.read_text())
        if result["figures"] or not can_evaluate:
            return result
    if not meshes.can_make(colmap, ablation):
        return None
    mesh, report = meshes.make_mesh(colmap, workspace, setting, ablation)
    figures = can_evaluate and attempt(f"{workspace.name}, {mesh.name}",
                                       evaluator, mesh)
    result = {"singular": meshes.singular_vertices(report),
              "figures": figures or None}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(result))
    return result


def measure_scene(colmap, workspace, ablations, setting_names, fused,
                  read_views, evaluator):
    """{(setting, ablation): result or None} of a scene."""
    def measure_all():
        prepare(colmap, workspace, read_views(), fused)
        return {
            (setting, ablation): attempt(
                f"{workspace.name}, {setting}, {ablation}", measure, colmap,
                workspace, setting, ablation, evaluator)
            for setting in setting_names for ablation in ablations}
    return attempt(workspace.name, measure_all) or {}


def measure_dtu(args, colmap, ablations):
    """{scan: {(setting, ablation): result}}."""
    results = {}
    for scan in args.scans:
        workspace = args.work / "dtu" / f"scan{scan}"
        results[scan] = measure_scene(
            colmap, workspace, ablations, args.settings,
            args.fused and args.fused / f"scan{scan}",
            lambda: dtu.read_views(
                args.dtu, scan, args.light,
                choose(args.pixel_center, DTU_PIXEL_CENTER)),
            lambda mesh: evaluate.dtu_metrics(
                colmap, mesh, args.dtu, scan, workspace))
    return results


def measure_epfl(args, colmap, ablations):
    """{scene: {(setting, ablation): result}}."""
    results = {}
    for scene in epfl.SCENES:
        folder = epfl.find_scene(args.epfl, scene)
        if folder is None:
            say(f"{scene}: no folder of that name in {args.epfl}.")
            continue
        workspace = args.work / "epfl" / scene
        center = choose(args.pixel_center, EPFL_PIXEL_CENTER)
        results[scene] = measure_scene(
            colmap, workspace, ablations, args.settings,
            args.fused and args.fused / scene,
            lambda: epfl.read_views(folder, center),
            lambda mesh: evaluate.epfl_shares(
                colmap, mesh, workspace, epfl.find_truth(
                    folder, workspace / "truth",
                    epfl.read_views(folder, center), args.depths_along_ray)))
    return results


def choose(value, default):
    return default if value is None else value


def by_setting(results, setting_names, ablations, key):
    """{scene: {(setting, ablation): result}} as {setting: {ablation: {scene:
    result[key]}}}, None where there is no result."""
    def look_up(scene, setting, ablation):
        result = results[scene].get((setting, ablation))
        return result and result[key]
    return {
        setting: {ablation: {scene: look_up(scene, setting, ablation)
                             for scene in results}
                  for ablation in ablations}
        for setting in setting_names}


def singular(results, setting_names):
    """What table II takes, from the reports of the initial meshes."""
    nested = by_setting(results, setting_names, ["initial"], "singular")
    return {setting: {scan: counts or (None, None) for scan, counts
                      in nested[setting]["initial"].items()}
            for setting in setting_names}


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("tables", nargs="+", type=int, choices=(1, 2, 3))
    parser.add_argument("--dtu", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--epfl", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--work", type=pathlib.Path, required=True,
                        metavar="DIR", help="where all is made and kept")
    parser.add_argument("--colmap", required=True, metavar="PROGRAM")
    parser.add_argument("--fused", type=pathlib.Path, metavar="DIR",
                        help="has SCENE/fused.ply and SCENE/fused.ply.vis")
    parser.add_argument("--settings", nargs="+", choices=settings.MESHING,
                        default=list(settings.MESHING),
                        help="the paper's and our defaults")
    parser.add_argument("--scans", nargs="+", type=int, metavar="SCAN",
                        choices=published.DTU_SCANS,
                        default=published.DTU_SCANS)
    parser.add_argument("--light", default=dtu.ALL_LIGHTS,
                        help="DTU's images rect_NNN_LIGHT.png "
                        f"({dtu.ALL_LIGHTS})")
    parser.add_argument("--pixel_center", type=float, metavar="PX",
                        help="of the first pixel, in the data set's matrices "
                        f"({DTU_PIXEL_CENTER} DTU, {EPFL_PIXEL_CENTER} EPFL)")
    parser.add_argument("--depths_along_ray", action="store_true",
                        help="EPFL's true depths are distances to the centre")
    args = parser.parse_args(arguments)
    if {1, 2} & set(args.tables) and not args.dtu:
        parser.error("tables 1 and 2 need --dtu")
    if 3 in args.tables and not args.epfl:
        parser.error("table 3 needs --epfl")
    if shutil.which(args.colmap) is None:
        parser.error(f"{args.colmap} is no program")
    return args


def main(arguments=None):
    args = parse_arguments(arguments)
    colmap = Colmap(args.colmap)
    for command in (settings.MESHER, evaluate.EVALUATOR, settings.REFINER):
        if command not in colmap.commands:
            say(f"{args.colmap} has no {command}: its figures are left out.")
    ablations = list(settings.ABLATIONS)
    if {1, 2} & set(args.tables):
        needed = ablations if 1 in args.tables else ["initial"]
        results = measure_dtu(args, colmap, needed)
        if 1 in args.tables:
            print(tables.table_1(by_setting(results, args.settings, ablations,
                                            "figures")))
        if 2 in args.tables:
            print(tables.table_2(singular(results, args.settings)))
    if 3 in args.tables:
        results = measure_epfl(args, colmap, ablations)
        print(tables.table_3(by_setting(results, args.settings, ablations,
                                        "figures")))


if __name__ == "__main__":
    main()
