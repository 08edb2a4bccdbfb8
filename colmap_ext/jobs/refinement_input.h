#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "colmap_ext/jobs/job_file.h"
#include "colmap_ext/jobs/plan.h"
#include "colmap_ext/options/refinement_options.h"
#include "formats/read_ply.h"
#include "mesh/split_fans.h"
#include "mesh/surface.h"
#include "photometry/image_pyramid.h"
#include "refine/facetwise_refinement.h"
#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"
#include "scene/region.h"
#include "scene/view.h"
#include "workspace/read_pictures.h"
#include "workspace/workspace.h"

namespace colmap_ext {

// Reads a mesh and its .vis. If it has none, no vertex has views.
// \param owner  of the .vis, see ReadVisibility()
// \throw FileError if it has no faces, or most have no area, or the .vis does
//        not fit
Surface ReadSurface(const std::filesystem::path& path, bool has_visibility,
                    const VisibilityOwner& owner);

// \param model  whose views they are, "plan"
// \throw FileError if the mesh's .vis lists a view that does not exist
void ExpectViews(const Surface& surface, size_t num_views,
                 const std::filesystem::path& path, const std::string& model,
                 const VisibilityOwner& owner);

// Paths of a refinement.
struct RefinementPaths {
  std::filesystem::path folder;  // the dense workspace
  std::filesystem::path mesh;
  std::filesystem::path fused;  // the points; need not be there
  std::filesystem::path output;
  std::filesystem::path refined_sparse;  // folder of the refined cameras

  bool HasFusedPoints() const { return std::filesystem::exists(fused); }
};

// \throw FileError if there is no workspace, or several, or no mesh.
RefinementPaths FindRefinementPaths(const RefinerOptions& options);

// Input of RefineFacetwise(), whose mesh is manifold, and how it was read.
struct RefinementInput : Surface {
  std::vector<View> views;
  PointCloud points;  // without the views whose pictures cannot be used
  std::vector<std::string> picture_errors;  // [views] empty: can be used
  std::shared_ptr<ImagePyramid> images;     // [views], read as memory allows
  std::shared_ptr<const RefinableCameras> cameras;
  bool is_part = false;     // see RefinementStart
  RefinementTile expected;  // what the run takes

  // Of what is drawn into the images and kept, bytes.
  size_t MaxDrawingMemory() const;

  WorkspaceReport workspace;
  bool has_fused_points = true;     // else the mesh's vertices stand for them
  bool has_visibility = true;       // of its own, beside the mesh
  std::optional<MaskReport> masks;  // of the points; nothing without masks
  std::optional<Region> region;     // that the mesh was cut off at
  std::string colors_from;          // where the vertices' colours come from
  std::optional<ManifoldRepair> repair;  // of the mesh, without its arrays
};

// Scales the input's views by image_scale, estimates the run, opens the
// pictures, and reads each once to see that it can be read; takes masked
// observations and unusable pictures from the points.
// \param surface  to be refined
// \param read_mask  of the views before, in full; empty: no masks
// \throw FileError if a picture cannot be used, unless such are skipped
void ReadPictures(const RefinerOptions& options, const Surface& surface,
                  const std::filesystem::path& images_path,
                  const ReadGrayImage& read_mask, const PictureDecoder& decoder,
                  RefinementInput* input);

// Reads a sparse model as the refinement of the cameras takes it.
// \param views  by the pictures' sizes; images of the model by their names
// \throw FileError if the model cannot be read, or has no such image.
std::shared_ptr<const RefinableCameras> ReadRefinableCameras(
    const std::filesystem::path& path, const std::vector<View>& views,
    std::shared_ptr<ImagePyramid> images);

// Reads the mesh with its .vis, the cameras, and the fused points, and reads
// all pictures once to see that they can be read.
//
// \pre options finished
// \throw FileError for whatever is missing, damaged, or does not fit together.
RefinementInput ReadRefinementInput(const RefinerOptions& options,
                                    const RefinementPaths& paths,
                                    const PictureDecoder& decoder,
                                    const Progress& progress);

// All that the result depends on, with fingerprints of the mesh, the fused
// points, the sparse model, the pictures and the masks.
// \param input  as ReadRefinementInput() has read it.
JobInputs RunInputs(const RefinerOptions& options, const RefinementPaths& paths,
                    const RefinementInput& input);

// Writes the sparse model of ReadRefinableCameras() with what was refined:
// poses and points, or also intrinsics, scaled to the cameras' sizes.
// \param positions  [P]
// \throw FileError as that, if there are other points, or it cannot write.
void WriteRefinedCameras(const std::filesystem::path& folder,
                         RefinedParts parts, const std::filesystem::path& path,
                         const std::vector<View>& views,
                         const std::vector<Eigen::Vector3d>& positions);

}  // namespace colmap_ext
