#pragma once

#include <optional>

#include "tests/tiles/memory_parts.h"
#include "tests/tiles/memory_plan.h"
#include "tests/tiles/seen_scene.h"
#include "tiles/cell_changes.h"
#include "tiles/seam_labels.h"

namespace colmap_ext {

// A plan whose tiles are done, cut along the seams and fixed.
struct MergedPlan {
  // \param rule  none: singular vertices are left
  MergedPlan(const SeenScene& scene, size_t num_tiles,
             std::optional<FixingRule> rule = {})
      : plan(PlanOf(scene.points, num_tiles, scene.observations)),
        parts(scene, plan),
        seam(plan.Blocks(), parts),
        changes(plan.Blocks()) {
    const int seam_rings = scene.options.seam_rings;
    num_contradictions = CutSeams(seam_rings, &seam);
    if (rule) {
      report =
          FixPlan(plan, parts, seam, *rule, seam_rings == kAllAtOnce, &changes);
    }
  }
  MergedPlan(const MergedPlan&) = delete;

  LabeledParts Labeled() const { return {parts, seam, changes}; }

  MemoryPlan plan;
  MemoryParts parts;
  SeamLabels seam;
  CellChanges changes;
  size_t num_contradictions = 0;
  FixingReport report;
};

}  // namespace colmap_ext
