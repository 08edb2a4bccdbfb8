#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/lru_cache.h"
#include "colmap_ext/jobs/job_file.h"
#include "colmap_ext/jobs/plan.h"
#include "tiles/plan_vertices.h"
#include "tiles/tile_cut.h"
#include "tiles/tile_patches.h"

namespace colmap_ext {

// The files of a plan: the blocks of all vertices, and of each tile its
// vertices, the cut of its cells, and its patch of the refined surface; and the
// surface before it is refined.
JobFile BlocksFile(const Plan& plan);
JobFile VerticesFile(const Plan& plan, size_t tile);
JobFile CutFile(const Plan& plan, size_t tile);
JobFile SurfaceFile(const RefinementPlan& plan);
JobFile PatchFile(const RefinementPlan& plan, size_t tile);

// \throw FileError if it cannot be written
void Write(const JobFile& file, const TileVertices& vertices);
void Write(const JobFile& file, const PlanBlocks& blocks);
void Write(const JobFile& file, const TileCut& cut, const TileSeam& seam);
void Write(const JobFile& file, const TriangleMesh& mesh,
           const VertexAttributes& attributes);
void Write(const JobFile& file, const TilePatch& patch);

// Readers of the files of a kind, one for each tile, of which few are open at a
// time: a plan may have more tiles than a process may open files.
class TileFiles {
 public:
  using Find = JobFile (*)(const Plan&, size_t);

  // \param plan  outlives this
  // \throw FileError if a file is missing, damaged, or of another plan
  TileFiles(const Plan& plan, Find find);

  std::shared_ptr<const JobFileReader> Open(size_t tile) const;

 private:
  const Plan& plan_;
  Find find_;
  mutable LruCache<const JobFileReader> open_;
};

// The vertices of a plan on disk.
class FilePlan : public PlanVertices {
 public:
  // \param plan  outlives this
  // \throw FileError if a file is missing, damaged, or of another plan
  explicit FilePlan(const Plan& plan);

  const PlanBlocks& Blocks() const override { return blocks_; }
  std::vector<Eigen::Vector3f> ReadPositions(uint32_t begin,
                                             uint32_t end) const override;
  Observations ReadObservations(uint32_t begin, uint32_t end) const override;

  // What the mesh inherits: colours, views and supports of some vertices.
  // \param ids  ascending
  TileVertices ReadAttributes(const std::vector<uint32_t>& ids) const;

 private:
  TileFiles files_;
  PlanBlocks blocks_;
};

// What the tiles' jobs have left on disk.
class FileParts : public TileParts {
 public:
  // \param plan  outlives this
  // \throw FileError if a tile is not done
  explicit FileParts(const Plan& plan);

  TileSeam ReadSeam(uint32_t tile) const override;
  TilePart ReadPart(uint32_t tile) const override;
  PartVertices ReadVertices(uint32_t tile) const override;
  uint32_t NumCells(uint32_t tile) const override;
  PartCells ReadCells(uint32_t tile, uint32_t begin,
                      uint32_t end) const override;

 private:
  TileFiles files_;
};

// The surface on disk, read on demand.
class FileSurface : public SurfaceStore {
 public:
  // \param plan  outlives this
  // \throw FileError if the mesh is missing, damaged or of another plan; the
  //        same for patches when they are read
  explicit FileSurface(const RefinementPlan& plan);

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

  const RefinementPlan& plan_;
  JobFileReader file_;
  std::vector<Eigen::AlignedBox3f> boxes_;  // [blocks]
};

}  // namespace colmap_ext
