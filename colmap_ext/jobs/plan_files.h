#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "base/lru_cache.h"
#include "colmap_ext/jobs/job_file.h"
#include "colmap_ext/jobs/plan.h"
#include "tiles/plan_vertices.h"
#include "tiles/thin_tile.h"
#include "tiles/tile_cut.h"

namespace colmap_ext {

// The files of a plan's tiles.
std::filesystem::path BlocksPath(const std::filesystem::path& folder);
std::filesystem::path VerticesPath(const std::filesystem::path& folder,
                                   size_t tile);
std::filesystem::path CutPath(const std::filesystem::path& folder, size_t tile);

// \throw FileError if it can not be written
void WriteVertices(const std::filesystem::path& folder, uint64_t identity,
                   size_t tile, const TileVertices& vertices);
void WriteBlocks(const std::filesystem::path& folder, uint64_t identity,
                 const PlanBlocks& blocks);
void WriteCut(const std::filesystem::path& folder, uint64_t identity,
              size_t tile, const TileCut& cut, const TileSeam& seam);

bool HasVertices(const std::filesystem::path& folder, uint64_t identity,
                 size_t tile);
bool HasCut(const std::filesystem::path& folder, uint64_t identity,
            size_t tile);

// The vertices of a plan on disk.
class FilePlan : public PlanVertices {
 public:
  // \throw FileError if a file is missing, damaged, or of another plan
  FilePlan(const std::filesystem::path& folder, const Plan& plan);

  const PlanBlocks& Blocks() const override { return blocks_; }
  std::vector<Eigen::Vector3f> ReadPositions(uint32_t begin,
                                             uint32_t end) const override;
  Observations ReadObservations(uint32_t begin, uint32_t end) const override;

  // What the mesh inherits: colours, views and supports of some vertices.
  // \param ids  ascending
  TileVertices ReadAttributes(const std::vector<uint32_t>& ids) const;

 private:
  std::shared_ptr<const JobFileReader> Open(size_t tile) const;

  std::filesystem::path folder_;
  uint64_t identity_;
  PlanBlocks blocks_;
  mutable LruCache<const JobFileReader> open_;
};

// What the tiles' jobs have left on disk.
class FileParts : public TileParts {
 public:
  // \throw FileError if a tile is not done
  FileParts(const std::filesystem::path& folder, const Plan& plan);

  TileSeam ReadSeam(uint32_t tile) const override;
  TilePart ReadPart(uint32_t tile) const override;
  PartVertices ReadVertices(uint32_t tile) const override;
  uint32_t NumCells(uint32_t tile) const override;
  PartCells ReadCells(uint32_t tile, uint32_t begin,
                      uint32_t end) const override;

 private:
  std::shared_ptr<const JobFileReader> Open(size_t tile) const;

  std::filesystem::path folder_;
  uint64_t identity_;
  mutable LruCache<const JobFileReader> open_;
};

}  // namespace colmap_ext
