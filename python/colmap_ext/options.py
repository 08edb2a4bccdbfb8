"""The options of the commands; scripts/option_tables writes this file."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal, Optional, Union

from .base_options import BaseOptions, Range, StrPath


@dataclass
class DelaunayManifoldMeshingOptions(BaseOptions):
    """Of delaunay_manifold_mesher."""

    report_path: Optional[StrPath] = None
    """Write a report, an HTML page with figures and pictures."""

    region: Optional[Union[StrPath, Sequence[float]]] = None
    """Mesh only inside this region: two opposite corners x0,y0,z0,x1,y1,z1 of a box, or
    a file, such as that of stereo_fusion --bbox_path (docs/tuning.md); auto: the part
    that most images look at, written beside the mesh: MESH.region.txt."""

    mask_path: Optional[StrPath] = None
    """Folder of image masks, PNG: image.jpg.png for image.jpg. Pixels of value 0 are
    ignored."""

    mask_background: bool = False
    """Treat masked pixels as background: everything along their rays is empty."""

    num_threads: Annotated[int, Range(1, 1024, also=-1)] = -1
    """[threads] Number of threads; -1: all cores. The result does not depend on it."""

    transform_path: Optional[StrPath] = None
    """Transform the written mesh by this file of model_aligner; its positions are
    double then."""

    quality: Literal["low", "medium", "high", "extreme"] = "high"
    """Preset of max_proj_dist: 40, 28, 20 or 10 px. A max_proj_dist that is given has
    priority."""

    max_proj_dist: Optional[Annotated[float, Range(0, 1000000)]] = None
    """[px] Leave out points nearer than a fifth of this to one that is kept; higher is
    coarser and faster. 0: keep every point. None: as quality says; 20 for high."""

    quality_regularization: Annotated[float, Range(0, 10000)] = 1.0
    """Weight of the surface quality; higher is smoother."""

    smoothing: Annotated[float, Range(0, 10)] = 1.0
    """Strength of the final smoothing, which moves vertices by about the noise of the
    points around them. 0: keep the vertices at fused points."""

    min_confidence: Annotated[float, Range(0, 1)] = 0.0
    """Remove faces with a lower confidence; 0.2 removes membranes that span sky or
    openings. 0: keep all."""

    close_holes: Annotated[float, Range(0, also=-1)] = 0.0
    """[px] Close holes up to this wide in the median of their views; 0: none, -1: all,
    even the outer border."""

    min_component_faces: Annotated[int, Range(0)] = 0
    """[faces] Remove components with fewer faces."""

    max_side_length_factor: Annotated[float, Range(0, 1000000)] = 20.0
    """Remove faces whose longest side is longer than this times the
    max_side_length_percentile of all faces' longest sides, unless they continue flat
    surface; 0: keep all."""

    remeshing: bool = False
    """Remesh the final surface into well-shaped faces, for meshes that are not
    refined."""

    # Advanced.

    input_type: Literal["dense", "sparse"] = "dense"
    """Mesh the fused points, or the points of the sparse model."""

    carve_with_depth_maps: bool = False
    """Carve free space along all depths of stereo/depth_maps, fused or not: less false
    surface, and less that few images see."""

    fused_path: Optional[StrPath] = None
    """Fused points, PLY, with their .vis. Default: WORKSPACE/fused.ply."""

    sparse_path: Optional[StrPath] = None
    """Sparse model with the cameras, or a folder that has one, such as
    WORKSPACE/sparse-refined. Default: WORKSPACE/sparse."""

    image_order: Literal["auto", "file", "image_id", "frame", "frame_id"] = "auto"
    """Order of the images by which .vis files number them. Set it if the command asks
    for it."""

    max_side_length_percentile: Annotated[float, Range(0, 100)] = 95.0
    """[%] Percentile that max_side_length_factor multiplies."""

    max_depth_dist: Annotated[float, Range(0, 1)] = 0.05
    """Leave out points only if nearer to one that is kept than this fraction of their
    depth."""

    drop_weaker_layers: bool = True
    """Where groups of images disagree and a wall is there twice, drop the points of the
    weaker layer; 0: keep both."""

    visibility_sigma: Annotated[float, Range(1e-06, 1000000)] = 3.0
    """[images] Images at which a point counts as well supported; higher values
    down-weight points seen by few images."""

    distance_sigma_factor: Annotated[float, Range(1e-06, 1000000)] = 1.0
    """Expected noise of the points, as a multiple of the 25th percentile of edge
    lengths; higher is smoother."""

    half_pixel_correction: Literal["auto", "full", "off"] = "auto"
    """Correct the half-pixel offset of COLMAP's fused points, by the amount that the
    sparse points show, by half a pixel, or not."""

    # Ablations of the paper.

    alpha_vis: Annotated[float, Range(1e-06, 1, also=0)] = 0.0
    """Weight of every observation; 0: 1 - exp(-n^2 / (2 s^2)) for a point seen by n
    images, s = visibility_sigma."""

    behind_sigma: Annotated[float, Range(1e-06, 1000000)] = 1.0
    """[distance sigmas] Assumed depth of solid behind a point."""

    preemptive_fixing: bool = True
    """Relabel and split cells around singular vertices before the surface is extracted;
    0: split these vertices instead."""

    fixing_rule: Literal["energy", "paper"] = "energy"
    """How singular vertices are removed: fewest remaining at the lowest cut energy, or
    the paper's three passes."""


@dataclass
class FacetwiseRefinementOptions(BaseOptions):
    """Of facetwise_refiner."""

    report_path: Optional[StrPath] = None
    """Write a report: NAME.html (page) and NAME.csv (iterations). Give either name."""

    resume: bool = False
    """Continue an interrupted run from its last complete level."""

    viewer: bool = False
    """Show the mesh in a window while it changes. T pauses; closing the window does not
    end the refinement."""

    region: Optional[Union[StrPath, Sequence[float]]] = None
    """Refine only inside, and remove the mesh outside of this region: two opposite
    corners x0,y0,z0,x1,y1,z1 of a box, or a file, such as that of stereo_fusion
    --bbox_path (docs/tuning.md); auto: the part that most images look at, written
    beside the mesh: MESH.region.txt."""

    mask_path: Optional[StrPath] = None
    """Folder of image masks, PNG: image.jpg.png for image.jpg. Pixels of value 0 are
    ignored."""

    transform_path: Optional[StrPath] = None
    """Transform the written mesh by this file of model_aligner; its positions are
    double then."""

    backend: Literal["auto", "cpu", "gl"] = "auto"
    """Processor or OpenGL 4.5. auto: OpenGL if there is a graphics card, else the
    processor."""

    gpu_index: Annotated[int, Range(0, also=-1)] = -1
    """Graphics card, by its index in EGL's device list; -1: the first suitable one."""

    num_threads: Annotated[int, Range(1, 1024, also=-1)] = -1
    """[threads] Number of threads; -1: all cores. The result does not depend on it."""

    max_memory_gb: Union[Annotated[float, Range(1e-09, 1000000)], Literal["auto"]] = "auto"
    """[GB] Memory to keep to if the mesh allows it: images and what is drawn into them
    are kept in what the mesh leaves, and read and drawn again beyond that. auto: three
    quarters of the machine's."""

    quality: Literal["low", "medium", "high", "extreme"] = "high"
    """Preset of image_scale, levels, iterations, max_face_area and
    final_pairs_per_face; options that are given have priority. low takes a quarter to a
    third of the time of high."""

    image_scale: Optional[Annotated[float, Range(0.05, 1)]] = None
    """Scale of the images that are compared: 0.5 is half the width and height, and a
    quarter of the time. None: as quality says; 1 for high."""

    levels: Optional[Annotated[int, Range(1, 8)]] = None
    """[levels] Image sizes, coarse to fine; 3: a quarter, half and full size. None: as
    quality says; 3 for high."""

    smoothness_weight: Annotated[float, Range(0, 1000000)] = 1.0
    """Factor on the estimated smoothness; higher is smoother."""

    max_face_area: Optional[Annotated[float, Range(0.5, 1000000)]] = None
    """[px^2] Area of a face in the image where the surface is curved; higher makes
    fewer faces. Flat parts get larger faces. None: as quality says; 7 for high."""

    refine_cameras: Literal["auto", "none", "poses", "poses_intrinsics"] = "auto"
    """Camera parameters to refine before the surface, written to
    WORKSPACE/sparse-refined, of a plan to PLAN/sparse-refined. auto: poses, only if the
    images are misaligned. The cameras of a rig move together."""

    min_confidence: Union[Annotated[float, Range(0, 1)], Literal["auto"]] = "auto"
    """Remove faces with a lower confidence; 0: keep all. auto: 0.15, or 0 without fused
    points or if no face has as much."""

    close_holes: Annotated[float, Range(0, also=-1)] = 64.0
    """[px] Close holes up to this wide in the median of their views; 0: none, -1: all,
    even the outer border."""

    skip_missing_images: bool = False
    """Continue without images that are missing, unreadable, or not of their camera's
    size."""

    # Advanced.

    fused_path: Optional[StrPath] = None
    """Fused points, PLY, with their .vis. Default: WORKSPACE/fused.ply."""

    sparse_path: Optional[StrPath] = None
    """Sparse model with the cameras, or a folder that has one, such as
    WORKSPACE/sparse-refined. Default: WORKSPACE/sparse."""

    labels_path: Optional[StrPath] = None
    """Write the mesh with faces colored by the image pair that refined them, PLY."""

    image_order: Literal["auto", "file", "image_id", "frame", "frame_id"] = "auto"
    """Order of the images by which .vis files number them. Set it if the command asks
    for it."""

    iterations: Optional[Annotated[int, Range(1)]] = None
    """[iterations] Maximum number at each level, without the last four. None: as
    quality says; 10 for high."""

    min_zncc: Annotated[float, Range(-1, 1)] = 0.5
    """Refine faces where the correlation of the images is at least this; other faces
    follow those around them. -1: all faces, as in the paper."""

    pairs_per_image: Annotated[int, Range(1)] = 4
    """[images] Images with which each image is paired."""

    final_pairs_per_face: Optional[Annotated[int, Range(0)]] = None
    """[pairs] Image pairs per face in the last two iterations, which determine the
    remaining noise; the two before use a third as many. 0: omit these four, as in the
    paper. None: as quality says; 18 for high."""

    remeshing: bool = True
    """Remesh before the last level into well-shaped faces, small where the surface is
    curved. 0: only subdivide large faces, as in the paper."""

    # Ablations of the paper.

    window: Annotated[int, Range(3, 15)] = 5
    """[px] Side of the compared windows; odd."""

    noise_variance: Annotated[float, Range(1e-06, 1000000)] = 2.0
    """[gray values^2] Variance of the image noise, for gray values of 0 to 255; higher
    down-weights windows without texture."""

    residual_floor: Annotated[float, Range(1e-06, 1000000)] = 0.05
    """Fraction of a window's variance that even the best match leaves unexplained. A
    large one weights all windows alike, as in the paper."""

    min_cosine: Annotated[float, Range(0, 0.99)] = 0.1
    """Ignore images where the cosine between face normal and viewing direction is below
    this."""

    occlusion_masking: bool = True
    """Ignore pixels of a window beyond a jump in depth."""

    pair_selection: Literal["facetwise", "classical"] = "facetwise"
    """Refine each face by its best image pairs, or by every pair that sees it."""

    pairs_per_face: Annotated[int, Range(1)] = 1
    """[pairs] Image pairs per face."""

    potts_weight: Annotated[float, Range(0, 1000000)] = 2.197
    """Cost of different image pairs on neighboring faces; higher makes larger
    patches."""

    solver: Literal["gauss_newton", "descent"] = "gauss_newton"
    """Move all vertices jointly, or each one along its gradient, as in the paper."""


@dataclass
class MeshEvaluationOptions(BaseOptions):
    """Of mesh_evaluator."""

    workspace_path: Optional[StrPath] = None
    """Workspace or sparse model with undistorted images. Count only surface that the
    images see, and compare depths."""

    sparse_path: Optional[StrPath] = None
    """Sparse model with the cameras, or a folder that has one, such as
    WORKSPACE/sparse-refined. Default: WORKSPACE/sparse."""

    json_path: Optional[StrPath] = None
    """Write the figures as JSON."""

    error_mesh_path: Optional[StrPath] = None
    """Write the mesh colored by the distances of its vertices to the truth, PLY."""

    picture_path: Optional[StrPath] = None
    """Write a picture of the colored mesh with its scale, PNG."""

    image_name: Optional[str] = None
    """Draw the picture from the camera of this image."""

    region: Optional[Union[StrPath, Sequence[float]]] = None
    """Count only samples inside this region: two opposite corners x0,y0,z0,x1,y1,z1 of
    a box, or a file, such as that of stereo_fusion --bbox_path (docs/tuning.md); auto:
    the part that most images look at."""

    stride: Annotated[int, Range(1, 1000)] = 3
    """[px] Cast a ray through every n-th pixel of a row and column."""

    spacing: Annotated[float, Range(0, 1000000000)] = 0.0
    """[scene units] Take one sample per cube of this side; 0: 0.001 times the truth's
    diagonal. DTU: 0.2 mm."""

    max_distance: Annotated[float, Range(0, 1000000000)] = 0.0
    """[scene units] Clip distances at this; 0: 0.05 times the truth's diagonal. DTU: 20
    mm."""

    drop_beyond: bool = False
    """Ignore distances beyond max_distance instead of clipping them, as DTU's own
    evaluation does."""

    depth_thresholds: Sequence[float] = (0.02, 0.1)
    """[scene units] Errors below which a depth counts as correct. EPFL: 0.02,0.1 m."""

    num_threads: Annotated[int, Range(1, 1024, also=-1)] = -1
    """[threads] Number of threads; -1: all cores. The result does not depend on it."""

    # Advanced.

    observability_mask: Optional[StrPath] = None
    """Count samples of the mesh only where this NumPy array [X,Y,Z] of uint8 is not 0
    (DTU's ObsMask)."""

    observability_box: Optional[Sequence[float]] = None
    """minx,miny,minz,resolution of that array (DTU's BB(1,:) and Res)."""

    ground_plane: Optional[Sequence[float]] = None
    """a,b,c,d: count samples of the truth only where ax + by + cz + d > 0 (DTU's
    Plane)."""

    error_scale: Annotated[float, Range(0, 1000000000)] = 0.0
    """[scene units] Error shown by the last color; 0: above 95 % of the errors."""
