"""DTU's MVS data set: its layout, its cameras, its masks.

H. Aanaes, R. Jensen et al., "Large-Scale Data for Multiple-View Stereopsis",
IJCV 2016; the layout is the one of its evaluation code. Units: mm.
"""

import numpy as np

from cameras import DTU_PIXEL_CENTER, image_number, read_dtu_projection
from colmap_model import View
from image_size import read_image_size

# All lights on: the "l3" of DTU's evaluation code.
ALL_LIGHTS = "3_r5000"

# DTU's evaluation code.
POINT_SPACING = 0.2  # mm, to which the mesh's samples are reduced
MAX_DISTANCE = 20.0  # mm, beyond which a distance is left out


def read_views(root, scan, light=ALL_LIGHTS, pixel_center=DTU_PIXEL_CENTER):
    """The images of a scan, with their cameras in COLMAP's conventions."""
    folder = root / "Rectified" / f"scan{scan}"
    paths = sorted(folder.glob(f"rect_*_{light}.png"))
    if not paths:
        raise FileNotFoundError(f"{folder} has no rect_*_{light}.png.")
    views = []
    for path in paths:
        position = image_number(path.name)
        camera = read_dtu_projection(
            root / "Calibration" / "cal18" / f"pos_{position:03d}.txt")
        views.append(View(path, camera.with_pixel_center(pixel_center),
                          read_image_size(path)))
    return views


def truth_path(root, scan):
    return root / "Points" / "stl" / f"stl{scan:03d}_total.ply"


def load_mat(path):
    """The variables of a .mat. Matlab's format is read by scipy.io."""
    try:
        import scipy.io
    except ImportError as error:
        raise ImportError(f"scipy.io is needed to read {path}.") from error
    with open(path, "rb") as file:
        return scipy.io.loadmat(file)


def convert_mask(source, target):
    """Writes ObsMaskN_10.mat as .npy, uint8 [x, y, z], 1 where DTU's scanner
    sees. Returns (x, y, z) of the centre of the first voxel and the side of a
    voxel, in mm: DTU's code takes voxel round((X - BB[0]) / Res), from 0."""
    variables = load_mat(source)
    mask = np.ascontiguousarray(variables["ObsMask"] != 0, dtype=np.uint8)
    target.parent.mkdir(parents=True, exist_ok=True)
    np.save(target, mask)
    return (*np.asarray(variables["BB"], dtype=float)[0].tolist(),
            float(np.squeeze(variables["Res"])))


def read_plane(path):
    """The plane P [4] of PlaneN.mat: points of the truth with P . (X, 1) > 0
    count towards the completeness, the table below them does not."""
    return np.asarray(load_mat(path)["P"], dtype=float).reshape(4).tolist()
