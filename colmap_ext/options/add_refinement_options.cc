#include "colmap_ext/options/add_refinement_options.h"

namespace colmap_ext {

namespace {

void AddPathOptions(CommandOptions* manager, RefinerOptions* refiner) {
  manager->AddDefaultOption(
      "workspace_path", &refiner->workspace_path,
      "The dense workspace, with images/ and sparse/, or a folder with one "
      "such in dense/ or dense/0/; required");
  manager->AddDefaultOption(
      "input_path", &refiner->input_path,
      "The mesh, a PLY of triangles, with its .vis if there is one. Default: "
      "WORKSPACE/meshed-delaunay-manifold.ply");
  manager->AddDefaultOption(
      "fused_path", &refiner->fused_path,
      "The fused points, PLY, where they are not fused.ply of the workspace; "
      "their .vis lies beside them");
  manager->AddDefaultOption("output_path", &refiner->output_path,
                            "The refined mesh; required with input_path. "
                            "Default: WORKSPACE/meshed-refined.ply");
  manager->AddDefaultOption(
      "sparse_path", &refiner->sparse_path,
      "The cameras, a sparse model or a folder with one, such as an earlier "
      "WORKSPACE/sparse-refined. Default: WORKSPACE/sparse");
  manager->AddDefaultOption(
      "report_path", &refiner->report_path,
      "A table of the iterations, CSV; beside it lie its plot, SVG, and a page "
      "on the whole run, HTML, by whose name all three can be asked for too");
  manager->AddDefaultOption(
      "labels_path", &refiner->labels_path,
      "The mesh with its faces coloured by the pair of images that refined "
      "them, PLY; a picture of it, PNG, lies beside it");
}

void AddModeOptions(CommandOptions* manager, RefinerOptions* refiner) {
  manager->AddDefaultOption(
      "plan", &refiner->plan_path,
      "The folder of mesh_planner. With input_path, the mesh that mesh_merger "
      "made of it, the refinement of its tiles is planned; with tile, one is "
      "refined, and mesh_merger --refined 1 makes the mesh of all");
  manager->AddNumber("tile", &refiner->tile, kCountOrMinusOne,
                     "The tile of the plan");
  manager->AddDefaultOption(
      "resume", &refiner->resume,
      "Go on from the last complete level of a run that was interrupted");
  manager->AddDefaultOption(
      "viewer", &refiner->viewer,
      "Show the mesh as it changes, in a window; T pauses, and closing it does "
      "not end the refinement");
  manager->AddDefaultOption(
      "image_order", &refiner->words.image_order,
      "How fused.ply.vis counts the images, where it can not be told: {auto, "
      "file, image_id, frame, frame_id}");
}

void AddMethodOptions(CommandOptions* manager, RefinerOptions* refiner) {
  FacetwiseRefinementOptions* refinement = &refiner->refinement;
  manager->AddNumber(
      "FacetwiseRefinement.levels", &refinement->levels, {1, 8},
      "Of the images, coarse to fine; 3: a quarter of their size, half, full");
  manager->AddNumber("FacetwiseRefinement.iterations", &refinement->iterations,
                     {1}, "At most, at each level");
  manager->AddNumber("FacetwiseRefinement.window", &refiner->window, {3, 15},
                     "[px] Side of the windows that are compared, odd");
  manager->AddNumber(
      "FacetwiseRefinement.noise_variance",
      &refinement->photometric.noise_variance, kPositive,
      "[grey values^2] Of the grey values, 0 ... 255; flat windows count less");
  manager->AddNumber(
      "FacetwiseRefinement.residual_floor",
      &refinement->photometric.residual_floor, kPositive,
      "Share of a window's variance that is left unexplained at best; with a "
      "large one all windows count alike, as in the paper");
  manager->AddNumber("FacetwiseRefinement.min_cosine",
                     &refinement->photometric.min_cosine, {0, 0.99},
                     "Faces are not compared in images that see them "
                     "under a smaller one");
  manager->AddNumber("FacetwiseRefinement.smoothness_weight",
                     &refinement->smoothness_weight, kNotNegative,
                     "Higher is smoother");
  manager->AddDefaultOption(
      "FacetwiseRefinement.refine_cameras", &refiner->words.refine_cameras,
      "{auto, none, poses, poses_intrinsics}: of the cameras, what is refined "
      "with the surface, and written to WORKSPACE/sparse-refined; auto: poses, "
      "but not of rigs, and only where the images are not aligned well");
  manager->AddDefaultOption(
      "FacetwiseRefinement.remeshing", &refinement->remeshing,
      "Remesh before the last level: faces of good shape, as large as the "
      "images call for; 0 only subdivides large faces, as in the paper");
  manager->AddNumber(
      "FacetwiseRefinement.max_face_area", &refinement->max_face_area,
      {0.5, 1e6},
      "[px^2] Of an image that a face covers; faces grow to it, or are "
      "subdivided down to it");
  manager->AddNumber(
      "FacetwiseRefinement.min_zncc", &refinement->min_zncc, {-1, 1},
      "Faces are refined where the images agree by this correlation; others "
      "follow what lies around them; -1 refines all, as in the paper");
}

void AddPairOptions(CommandOptions* manager, RefinerOptions* refiner) {
  FacetwiseRefinementOptions* refinement = &refiner->refinement;
  manager->AddNumber("FacetwiseRefinement.pairs_per_image",
                     &refinement->pairs_per_image, {1},
                     "Partners of each image");
  manager->AddNumber("FacetwiseRefinement.pairs_per_facet",
                     &refinement->labeling.pairs_per_facet, {1},
                     "Pairs of images that refine a face");
  manager->AddNumber(
      "FacetwiseRefinement.final_pairs_per_facet",
      &refinement->labeling.final_pairs_per_facet, {0},
      "The same in the last iterations of all, if more, and a third in those "
      "before; 0 leaves these out: the paper's method");
  manager->AddNumber("FacetwiseRefinement.potts_weight",
                     &refinement->labeling.potts_weight, kNotNegative,
                     "Cost of refining neighboring faces by different "
                     "pairs");
  manager->AddDefaultOption(
      "FacetwiseRefinement.pair_selection", &refiner->words.pair_selection,
      "{facetwise, classical}: each face by its best pairs, or by every pair "
      "that sees it");
}

void AddVariantOptions(CommandOptions* manager, RefinerOptions* refiner) {
  manager->AddDefaultOption(
      "FacetwiseRefinement.occlusion_masking",
      &refiner->refinement.photometric.occlusion_masking,
      "Leave out of a window what lies across a jump in depth");
  manager->AddDefaultOption("FacetwiseRefinement.solver",
                            &refiner->words.solver,
                            "{gauss_newton, descent}: all vertices at once, or "
                            "each by itself along the gradient, as in the "
                            "paper");
}

void AddBorderOptions(CommandOptions* manager, RefinerOptions* refiner) {
  BorderOptions* borders = &refiner->refinement.borders;
  manager->AddNumber(
      "FacetwiseRefinement.trim", &refiner->trim, {0, 1, -1},
      "Faces of less confidence are dropped; 0: none; -1: 0.2, or "
      "none where there is no fused.ply or no face has as much");
  manager->AddNumber(
      "FacetwiseRefinement.close_holes", &borders->close_holes,
      kCountOrMinusOne,
      "[edges] Holes of up to as many are closed; -1: all, 0: none");
}

void AddMissingImagesOption(CommandOptions* manager, RefinerOptions* refiner) {
  manager->AddDefaultOption("FacetwiseRefinement.skip_missing_images",
                            &refiner->skip_missing_images,
                            "Go on without images that are missing, can not be "
                            "read, or are not of their camera's size");
}

void AddRunOptions(CommandOptions* manager, RefinerOptions* refiner) {
  manager->AddDefaultOption("FacetwiseRefinement.backend",
                            &refiner->words.backend,
                            "{auto, cpu, gl}: the processor, or OpenGL 4.5; "
                            "auto: OpenGL on a graphics card, or else the "
                            "processor");
  manager->AddNumber(
      "FacetwiseRefinement.gpu_index", &refiner->gpu_index, kCountOrMinusOne,
      "Of the graphics card, as EGL lists them; -1: the first that will do");
  manager->AddNumber("FacetwiseRefinement.num_threads", &refiner->num_threads,
                     kThreads,
                     "[threads] -1 for all; the result does not depend on it");
  manager->AddNumber(
      "FacetwiseRefinement.max_memory_gb", &refiner->max_memory_gb, kGigabytes,
      "[GB] For images and what is drawn into them; what does not fit is "
      "read and drawn again");
  AddMissingImagesOption(manager, refiner);
  manager->AddNumber(
      "FacetwiseRefinement.snapshot_interval", &refiner->snapshot_interval, {0},
      "[iterations] Write OUTPUT.LEVEL.ITERATION.ply every so many; 0: never");
}

}  // namespace

void AddRefinerOptions(CommandOptions* manager, RefinerOptions* refiner) {
  AddPathOptions(manager, refiner);
  AddModeOptions(manager, refiner);
  AddSceneOptions(manager, "What is refined, the rest is cut off",
                  &refiner->scene);
  AddMethodOptions(manager, refiner);
  AddPairOptions(manager, refiner);
  AddVariantOptions(manager, refiner);
  AddBorderOptions(manager, refiner);
  AddRunOptions(manager, refiner);
}

void AddResultOptions(CommandOptions* manager, RefinerOptions* refiner) {
  AddMethodOptions(manager, refiner);
  AddPairOptions(manager, refiner);
  AddVariantOptions(manager, refiner);
  AddBorderOptions(manager, refiner);
  AddMissingImagesOption(manager, refiner);
}

}  // namespace colmap_ext
