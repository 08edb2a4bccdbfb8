#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "colmap_ext/jobs/job_file.h"
#include "tiles/surface_patches.h"

namespace colmap_ext {

// The files of a surface that is refined tile by tile, in the plan's folder:
// the mesh as it is before, and the patch of each tile's job.
std::filesystem::path PatchPath(const std::filesystem::path& folder,
                                size_t tile);

// \throw FileError if it can not be written
void WriteSurface(const std::filesystem::path& folder, uint64_t identity,
                  const TriangleMesh& mesh, const VertexAttributes& attributes);
void WritePatch(const std::filesystem::path& folder, uint64_t identity,
                size_t tile, const TilePatch& patch);

bool HasSurface(const std::filesystem::path& folder, uint64_t identity);
bool HasPatch(const std::filesystem::path& folder, uint64_t identity,
              size_t tile);

// The surface on disk, read on demand.
class FileSurface : public SurfaceStore {
 public:
  // \throw FileError if the mesh is missing, damaged or of another plan; the
  //        same for patches when they are read
  FileSurface(std::filesystem::path folder, uint64_t identity);

  size_t NumBlocks() const override { return boxes_.size(); }
  Eigen::AlignedBox3f BlockBox(size_t block) const override {
    return boxes_[block];
  }
  SurfacePart ReadBlock(size_t block) const override;
  Eigen::AlignedBox3f PatchBox(uint32_t tile) const override;
  std::vector<SurfaceId> ReadRemoved(uint32_t tile) const override;
  SurfacePart ReadPatchPart(uint32_t tile) const override;

 private:
  JobFileReader Patch(uint32_t tile) const;

  std::filesystem::path folder_;
  uint64_t identity_;
  JobFileReader file_;
  std::vector<Eigen::AlignedBox3f> boxes_;  // [blocks]
};

}  // namespace colmap_ext
