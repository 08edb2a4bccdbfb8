#include "colmap_ext/jobs/tile_state.h"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "colmap_ext/jobs/refinement_state.h"
#include "colmap_ext/jobs/surface_files.h"
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
  uint64_t hash = HashValues(part.ids, 0);
  hash = HashValues(part.facet_ids, hash);
  hash = HashValues(part.mesh.vertices, hash);
  return HashValues(part.mesh.facets, hash);
}

}  // namespace

TileState::TileState(const RefinementJob& job, const SurfacePart& part,
                     const std::vector<std::string>& picture_errors)
    : output_(PatchPath(job.folder, job.tile)),
      inputs_(
          {{{"refinement", fmt::format("{}", job.refinement.identity)},
            {"tile", fmt::format("{}", job.tile)},
            {"surface", fmt::format("{:016x}", HashOf(part))},
            {"pictures", fmt::format("{}", fmt::join(picture_errors, "\n"))}},
           {}}) {}

int TileState::GoOn(const std::vector<View>& views, RefinementStart* start) {
  RefinementState state;
  try {
    state = ReadState(output_, inputs_, views);
  } catch (const FileError&) {
    return 0;
  }
  start->mesh = std::move(state.mesh);
  start->attributes = std::move(state.attributes);
  start->origins = std::move(state.origins);
  start->first_level = state.level - 1;
  start->fixed_sources = std::move(state.fixed_sources);
  return state.level;
}

void TileState::Write(int level, const RefinedMesh& state) const {
  WriteState(output_, inputs_,
             {level, state.mesh, state.attributes, state.origins,
              state.fixed_sources, state.views, state.report});
}

}  // namespace colmap_ext
