#pragma once

#include <string>

#include "colmap_ext/options/region_option.h"
#include "evaluation/mesh_evaluation.h"

namespace colmap_ext {

// Options of mesh_evaluator.
struct EvaluatorOptions {
  std::string mesh_path;
  std::string truth_path;  // PLY, or a folder of depth maps
  std::string workspace_path;
  std::string sparse_path;         // of the workspace; empty: its own
  RegionOption region;             // what counts
  std::string observability_mask;  // NumPy file
  std::string observability_box;   // "minx,miny,minz,resolution"
  std::string ground_plane;        // "a,b,c,d"
  std::string json_path;
  std::string error_mesh_path;
  std::string picture_path;
  std::string picture_image;  // name of the image that sees the picture
  MeshEvaluationOptions evaluation;
  std::string depth_thresholds = "0.02,0.1";
  double error_scale = 0;  // end of the colours' scale, scene units; 0: round
  int num_threads = -1;

  // Reads the numbers in the texts.
  // \throw OptionError if something is wrong with any of the options.
  void Finish();
  Observability ReadObservability() const;
};

}  // namespace colmap_ext
