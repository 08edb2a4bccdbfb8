"""The paper's settings and ablations as options of our commands."""

MESHER = "delaunay_manifold_mesher"
REFINER = "facetwise_refiner"

_MESHING = "DelaunayManifoldMeshing."

# What the paper says of its mesher (section IV): one weight alpha_vis for all
# observations, sigma = the 25th percentile of the edge lengths (the default of
# distance_sigma_factor), matter 3 sigma behind a point, its three passes of
# fixing. It corrects no half pixel. It leaves open: alpha_vis, the weight of
# the surface's quality, the thinning of the cloud, whether long faces or small
# components are dropped; those stay at our defaults.
PAPER_MESHING = {
    _MESHING + "alpha_vis": 1,
    _MESHING + "behind_sigma": 3,
    _MESHING + "fixing_rule": "paper",
    _MESHING + "half_pixel_correction": "off",
}

MESHING = {"paper": PAPER_MESHING, "default": {}}
NO_FIXING = {_MESHING + "preemptive_fixing": 0}

# The classical refinement, every pair on the whole mesh.
WHOLE_MESH = {"FacetwiseRefinement.pair_selection": "classical"}

# By ablation: what is left out of the method.
ABLATIONS = {
    "initial": "initial mesh",
    "no_fixing": "w/o preemptive fixing",
    "whole_mesh": "w/o facetwise pairs",
    "all": "all",
}
