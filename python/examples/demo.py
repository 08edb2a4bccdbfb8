# %% [markdown]
# # From fused points to a measured mesh
#
# Needs NumPy and the programs: `scripts/build --target colmap_ext make_workspace`.
# Run it in the root of the repository, as a script or cell by cell in an editor that
# knows `# %%`.

# %%
import os
import pathlib
import subprocess

import colmap_ext

os.environ.setdefault("COLMAP_EXT", "build/release/bin/colmap_ext")
make_workspace = os.environ.get("COLMAP_EXT_MAKE_WORKSPACE",
                                "build/release/tests/make_workspace")
workspace = pathlib.Path("build/demo-python")

# %% [markdown]
# A small synthetic workspace whose surface is known.

# %%
if not (workspace / "fused.ply.vis").exists():
    subprocess.run([make_workspace, "--output_path", workspace, "--num_images", "8",
                    "--width", "320", "--height", "240"], check=True)

# %% [markdown]
# The mesh of the fused points. `progress=True` shows a bar if tqdm is installed.

# %%
coarse = workspace / "meshed-delaunay-manifold.ply"
meshing = colmap_ext.DelaunayManifoldMeshingOptions(max_proj_dist=10)
colmap_ext.delaunay_manifold_meshing(workspace, coarse, meshing, progress=True)

# %% [markdown]
# The mesh refined by the images. After Ctrl-C, or "Interrupt" in a notebook, set
# `refinement.resume = True` and run the cell again: it continues.

# %%
refined = workspace / "meshed-refined.ply"
refinement = colmap_ext.FacetwiseRefinementOptions(levels=2)
zncc = []  # mean correlation of the images, by iteration


def show(progress: colmap_ext.Progress) -> None:
    print(progress)
    if progress.zncc is not None:
        zncc.append(progress.zncc)


colmap_ext.facetwise_refinement(workspace, coarse, refined, refinement, progress=show)
print(f"ZNCC {zncc[0]:.3f} -> {max(zncc):.3f}")

# %% [markdown]
# Both meshes against the true one.

# %%
evaluation = colmap_ext.MeshEvaluationOptions(workspace_path=workspace)
for mesh in (coarse, refined):
    figures = colmap_ext.mesh_evaluation(mesh, workspace / "truth/mesh.ply", evaluation)
    print(f"{mesh.name}: mean accuracy {figures['accuracy']['mean']:.4f}, "
          f"completeness {figures['completeness']['mean']:.4f} scene units; "
          f"2-manifold: {figures['topology']['is_manifold']}")

# %% [markdown]
# The mesh as arrays, and in other libraries where they are installed.

# %%
ply = colmap_ext.read_ply(refined)
views = colmap_ext.read_vis(f"{refined}.vis")
print(f"vertices {ply.vertices.shape}, faces {ply.faces.shape}; "
      f"images that see vertex 0: {views[0]}")
try:
    print(ply.to_trimesh())
except ImportError:
    print("trimesh is not installed")
