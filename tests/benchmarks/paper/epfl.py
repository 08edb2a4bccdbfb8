"""EPFL's (Strecha's) fountain-P11 and Herz-Jesu-P8: layout and cameras.

C. Strecha et al., "On Benchmarking Camera Calibration and Multi-View Stereo
for High Resolution Imagery", CVPR 2008. Units: m.
"""

from cameras import EPFL_PIXEL_CENTER, read_strecha_camera
from colmap_model import View
from depth_maps import ray_to_z, read_depths, write_colmap_map
from image_size import read_image_size

# By the paper's name of the scene: possible folders.
SCENES = {
    "fountain": ("fountain-P11", "fountain", "fountain_dense"),
    "herzjesu": ("Herz-Jesus-P8", "herzjesu", "herzjesu_dense",
                 "Herz-Jesu-P8"),
}
DEPTH_SUFFIXES = (".bin", ".pfm", ".npy")


def find_scene(root, scene):
    """The folder of a scene, or None."""
    folders = [root / name for name in SCENES[scene]]
    return next((folder for folder in folders if folder.is_dir()), None)


def find_files(folder, pattern):
    """Files under a folder, sorted by name; downloads differ in subfolders."""
    return sorted(folder.rglob(pattern), key=lambda path: path.name)


def read_views(folder, pixel_center=EPFL_PIXEL_CENTER):
    """The images that have a .camera file, with their cameras in COLMAP's
    conventions."""
    views = []
    for camera_path in find_files(folder, "*.camera"):
        name = camera_path.name.removesuffix(".camera")
        images = find_files(folder, name)
        if not images:
            raise FileNotFoundError(f"{camera_path}: no image {name}.")
        camera, size = read_strecha_camera(camera_path)
        if read_image_size(images[0]) != size:
            raise ValueError(f"{images[0]} has not the size of its camera.")
        views.append(View(images[0], camera.with_pixel_center(pixel_center),
                          size))
    if not views:
        raise FileNotFoundError(f"{folder} has no *.camera.")
    return views


def find_truth(folder, target, views, along_ray):
    """The truth of a scene: its scanned mesh, else target, a folder to which
    its depth maps are converted."""
    mesh = find_truth_mesh(folder)
    if mesh is None and not convert_depths(folder, target, views, along_ray):
        raise FileNotFoundError(f"{folder} has neither a .ply nor depth maps.")
    return mesh or target


def find_truth_mesh(folder):
    """The laser-scanned mesh: the one .ply of the folder, or None."""
    meshes = find_files(folder, "*.ply")
    if len(meshes) > 1:
        raise ValueError(f"{folder} has several .ply: " + ", ".join(
            mesh.name for mesh in meshes))
    return meshes[0] if meshes else None


def convert_depths(folder, target, views, along_ray):
    """Writes the depth maps named after the views (0000.pfm, or
    0000.png.pfm, ...) as target/NAME.bin, COLMAP's form. along_ray: they hold
    distances from the camera's centre rather than depths. Returns how many."""
    count = 0
    for view in views:
        stems = (view.name, view.path.stem)
        paths = [path for stem in stems for suffix in DEPTH_SUFFIXES
                 for path in find_files(folder, stem + suffix)]
        if not paths:
            continue
        depths = read_depths(paths[0])
        if depths.shape != view.size[::-1]:
            raise ValueError(f"{paths[0]} has not the size of its image.")
        if along_ray:
            depths = ray_to_z(depths, view.camera)
        write_colmap_map(target / f"{view.name}.bin", depths)
        count += 1
    return count
