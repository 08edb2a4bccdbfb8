#pragma once

#include <string>

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/scene_options.h"
#include "evaluation/mesh_evaluation.h"

namespace colmap_ext {

// Options of mesh_evaluator.
struct EvaluatorOptions {
  std::string mesh_path;
  std::string truth_path;  // PLY, or a folder of depth maps
  std::string workspace_path;
  std::string sparse_path;         // of the workspace; empty: its own
  RegionOption region;             // only samples inside count
  std::string observability_mask;  // NumPy file
  std::string observability_box;   // "minx,miny,minz,resolution"
  std::string ground_plane;        // "a,b,c,d"
  std::string json_path;
  std::string error_mesh_path;
  std::string picture_path;
  std::string image_name;  // the picture is drawn from this image's camera
  MeshEvaluationOptions evaluation;
  std::string depth_thresholds = "0.02,0.1";
  double error_scale = 0;  // end of the color scale, scene units; 0: automatic

  // Reads the numbers in the texts.
  // \throw OptionError if something is wrong with any of the options.
  void Finish();
  Observability ReadObservability() const;
};

// Adds the options to those of a command.
// \param evaluator  must outlive the parsing.
void AddEvaluatorOptions(CommandOptions* options, EvaluatorOptions* evaluator);

}  // namespace colmap_ext
