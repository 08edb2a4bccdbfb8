#include "colmap_ext/tiling/tile_state.h"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "colmap_ext/refinement/file_fingerprint.h"
#include "colmap_ext/refinement/refinement_state.h"
#include "colmap_ext/tiling/surface_files.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

template <typename T>
uint64_t HashValues(const std::vector<T>& values, uint64_t hash) {
  return HashBytes(
      {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)},
      hash);
}

// Of what the job starts from: lower colours may have been refined again, by
// another backend.
uint64_t HashOf(const SurfacePart& part) {
  uint64_t hash = HashValues(part.ids, HashBytes(""));
  hash = HashValues(part.facet_ids, hash);
  hash = HashValues(part.mesh.vertices, hash);
  return HashValues(part.mesh.facets, hash);
}

}  // namespace

TileState::TileState(const RefinementJob& job, const SurfacePart& part,
                     const std::vector<std::string>& picture_errors)
    : output_(PatchPath(job.folder, job.tile)),
      identity_(
          {{"refinement", fmt::format("{}", job.refinement.identity)},
           {"tile", fmt::format("{}", job.tile)},
           {"surface", fmt::format("{:016x}", HashOf(part))},
           {"pictures", fmt::format("{}", fmt::join(picture_errors, "\n"))}}) {}

int TileState::GoOn(const std::vector<View>& views, RefinementStart* start) {
  RefinementState state;
  try {
    state = ReadState(output_, identity_, views);
  } catch (const FileError&) {
    return 0;
  }
  start->mesh = std::move(state.mesh);
  start->attributes = std::move(state.attributes);
  start->origins = std::move(state.origins);
  start->first_level = state.level - 1;
  start->fixed = FixedOf(state.fixed_sources);
  before_ = std::move(state.fixed_sources);
  return state.level;
}

void TileState::Write(int level, const RefinedMesh& state) const {
  WriteState(output_, identity_,
             {level, state.mesh, state.attributes, state.origins,
              SourcesInPart(state.fixed_sources), state.views, state.report});
}

FixedSources TileState::SourcesInPart(const FixedSources& sources) const {
  return before_.empty() ? sources : CarrySources(before_, sources);
}

void RemoveTileState(const fs::path& folder, uint32_t tile, int num_levels) {
  for (int level = 1; level < num_levels; ++level) {
    RemoveState(PatchPath(folder, tile), level);
  }
}

}  // namespace colmap_ext
