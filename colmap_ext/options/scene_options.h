#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "colmap_ext/options/command_options.h"
#include "formats/atomic_file.h"
#include "scene/region.h"
#include "scene/view.h"
#include "workspace/image_order.h"

namespace colmap_ext {

// The value of --region: empty, "auto", two corners "x0,y0,z0,x1,y1,z1", or a
// file that ReadRegion() reads.
struct RegionOption {
  std::string text;  // as typed

  // The same, read by Finish().
  bool is_auto = false;
  std::optional<Region> region;

  // \throw OptionError if it is none of these; FileError if the file is no
  //        region.
  void Finish();

  // The region: for "auto" the FocusRegion().
  // \pre finished
  // \throw OptionError if no region is found.
  std::optional<Region> Resolve(
      const std::vector<View>& views,
      const std::vector<Eigen::Vector3f>& sparse_points) const;

  // Path of the file for a found region: "mesh.region.txt" for "mesh.ply"; for
  // "auto" alone, else empty.
  std::filesystem::path FoundPath(std::filesystem::path mesh_path) const;

  // Writes a region that was found automatically, if the option requests that,
  // beside the mesh and together with it.
  // \throw FileError if it cannot be written.
  void WriteFound(const std::optional<Region>& found,
                  const std::filesystem::path& mesh_path,
                  AtomicFiles* together) const;
};

// Which part of a scene a mesh covers, and the frame that it is written in.
struct SceneOptions {
  std::string mask_path;       // a folder; empty: no masks
  std::string transform_path;  // of the mesh that is written; empty: none
  std::optional<Eigen::Matrix4d> transform;  // the same, read by Finish()
  RegionOption region;                       // the mesh is inside

  // \throw OptionError, FileError as RegionOption::Finish(); FileError if the
  //        transform cannot be read.
  void Finish();
};

inline constexpr const char* kWrittenAutoRegion =
    "; auto: the part that most images look at, written beside the mesh: "
    "MESH.region.txt";

// Add options that several commands have.
// \param effect  of the region: "Mesh only inside".
// \param automatic  the meaning of "auto"
void AddRegionOption(const std::string& effect, RegionOption* region,
                     const std::string& automatic, CommandOptions* options);
void AddMaskOption(std::string* mask_path, CommandOptions* options);
void AddTransformOption(std::string* transform_path, CommandOptions* options);
void AddImageOrderOption(std::optional<ImageOrderKind>* order,
                         CommandOptions* options);
void AddFusedPathOption(CommandOptions::Value path, CommandOptions* options);
void AddSparsePathOption(CommandOptions::Value path, CommandOptions* options);
void AddGpuIndexOption(int* gpu_index, CommandOptions* options);

}  // namespace colmap_ext
