#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "colmap_ext/options/refinement_options.h"
#include "refine/facetwise_refinement.h"
#include "scene/picture_decoder.h"
#include "workspace/masks.h"

namespace colmap_ext {

struct RefineTileReport {
  bool is_kept = false;  // it was done before: nothing was done
  uint32_t color = 0;
  size_t num_views = 0;             // that were read
  std::optional<MaskReport> masks;  // of vertices; nothing without masks
  size_t num_facets = 0;            // of the surface that were read
  size_t num_removed = 0;           // of them refined
  size_t num_added = 0;             // that they became
  std::string computed_by;          // the backend
  int resumed_level = 0;            // resumed after it; 0: from the start
  int last_level = 0;               // that is complete on disk; 0: none
  RefinementReport refinement;
  std::vector<std::string> warnings;  // of what computes, one line each
};

// Refines a tile of a plan, once: its file is complete or does not exist. An
// interrupted job is resumed after its last complete level.
//
// The job's facets are those in the tile's cell and a margin around it, except
// those that the tiles of lower colours have refined in their own cells. All
// other facets are fixed; they are read if they may hide the tile from a
// camera.
//
// \param options  how to compute; what to compute comes from the plan
// \param hooks  may stop it
// \throw FileError if something is missing, damaged or of another plan, a tile
//        of a lower colour is not refined, or an input has changed
RefineTileReport RefineTile(const std::filesystem::path& folder, uint32_t tile,
                            RefinerOptions options,
                            const PictureDecoder& decoder,
                            const RefinementHooks& hooks);

}  // namespace colmap_ext
