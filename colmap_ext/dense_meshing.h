// What COLMAP's own sources call once patches/ has changed them: its automatic
// reconstruction meshes and refines dense workspaces by our commands.
//
// COLMAP's libraries include this header and cannot link ours, which link
// them: the program sets what runs the commands. COLMAP 3.8 compiles it as
// C++14.

#pragma once

#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

namespace colmap_ext {

struct DenseMeshing {
  // Runs a command by its name and options.
  // \return its exit status.
  int (*run)(const std::vector<std::string>& arguments) = nullptr;

  // Of the last command that failed; else 0.
  int exit_status = 0;
};

// The only one of the program.
inline DenseMeshing& GlobalDenseMeshing() {
  static DenseMeshing dense_meshing;
  return dense_meshing;
}

// Request of automatic_reconstructor.
struct DenseMeshingRequest {
  std::string workspace_path;  // that has dense/0, dense/1 ...
  size_t num_workspaces = 0;
  int mesher = 0;  // COLMAP's: 0 Poisson, 1 Delaunay, 2 advancing front
  bool is_manifold = false;  // the mesher is ours
  bool is_refined = false;
  int quality = 2;  // COLMAP's: 0 low, 1 medium, 2 high, 3 extreme
  int num_threads = -1;
};

// Where the mesh of a dense workspace goes.
template <typename Path>  // std::string up to COLMAP 3.13, then a path
Path ManifoldMeshPath(const Path& dense_path) {
  return Path(std::string(dense_path) + "/meshed-delaunay-manifold.ply");
}

// Meshes the dense workspaces that have fused points, and refines their meshes,
// if requested and not done yet. Failures are printed, and stored in
// GlobalDenseMeshing().
inline void FinishDenseWorkspaces(const DenseMeshingRequest& request) {
  DenseMeshing& dense_meshing = GlobalDenseMeshing();
  const auto exists = [](const std::string& path) {
    return std::ifstream(path).good();
  };
  const auto run = [&dense_meshing](const std::vector<std::string>& arguments) {
    const int status =
        dense_meshing.run != nullptr ? dense_meshing.run(arguments) : 1;
    if (status != 0) {
      dense_meshing.exit_status = status;
    }
  };
  const std::string threads = std::to_string(request.num_threads);
  const char* const names[] = {"poisson", "delaunay", "advancing-front"};
  const char* const qualities[] = {"low", "medium", "high", "extreme"};
  const std::string quality = qualities[request.quality];
  for (size_t i = 0; i < request.num_workspaces; ++i) {
    const std::string path =
        request.workspace_path + "/dense/" + std::to_string(i);
    const std::string mesh_path =
        request.is_manifold
            ? ManifoldMeshPath(path)
            : path + "/meshed-" + names[request.mesher] + ".ply";
    const std::string refined_path = path + "/meshed-refined.ply";
    if (!exists(path + "/fused.ply")) {
      continue;
    }
    if (request.is_manifold && !exists(mesh_path)) {
      run({"delaunay_manifold_mesher", "--workspace_path", path, "--quality",
           quality, "--DelaunayManifoldMeshing.num_threads", threads});
    }
    if (request.is_refined && exists(mesh_path) && !exists(refined_path)) {
      run({"facetwise_refiner", "--workspace_path", path, "--input_path",
           mesh_path, "--output_path", refined_path, "--quality", quality,
           "--FacetwiseRefinement.num_threads", threads});
    }
  }
}

// Adds our commands to the script that COLMAP's image_undistorter writes into a
// dense workspace. The empty line ends COLMAP 4's last one, which ends in a
// backslash.
template <typename Path>
void WriteMeshingCommands(const Path& workspace_path,
                          const std::string& workspace_format,
                          const std::string& indent, std::ofstream* file) {
  if (workspace_format != "COLMAP") {
    return;
  }
  *file << "\n";
  for (const char* command :
       {"delaunay_manifold_mesher", "facetwise_refiner"}) {
    *file << indent << "$COLMAP_EXE_PATH/colmap " << command << " \\\n"
          << indent << "  --workspace_path " << std::string(workspace_path)
          << "\n";
  }
}

}  // namespace colmap_ext
