#include "refine/facetwise_refinement.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "base/heap.h"
#include "base/rows.h"
#include "raster/visibility_buffers.h"
#include "refine/facet_sizes.h"
#include "refine/level_refinement.h"
#include "refine/refined_confidences.h"

namespace colmap_ext {
namespace {

class Refinement {
 public:
  Refinement(const FacetwiseRefinementOptions& options, RefinementStart start,
             const std::vector<View>& views, const PointCloud& points,
             PhotometricEnergy* energy, const RefinementHooks& hooks)
      : options_(options),
        points_(points),
        has_fused_points_(start.has_fused_points),
        cameras_(std::move(start.cameras)),
        alignment_(std::move(start.alignment)),
        pairs_(SelectViewPairs(points, views.size(), options.pairs_per_image)),
        energy_(energy),
        hooks_(hooks) {
    if (start.origins.empty()) {
      start.origins = start.mesh.vertices;
    }
    static_cast<Surface&>(state_) = std::move(static_cast<Surface&>(start));
    state_.views = views;
  }

  RefinedMesh Run(int first_level, bool is_part) {
    if (!AreCamerasUsable()) {
      state_.report.is_skipped = true;
      state_.labels.labels = Rows<uint32_t>(state_.mesh.facets.size());
      first_level = -1;
    }
    for (int level = first_level; level >= 0; --level) {
      if (!RefineAtLevel(level)) {
        state_.report.is_stopped = true;
        return std::move(state_);
      }
      if (hooks_.on_level) {
        hooks_.on_level(level, state_);
      }
    }
    if (!is_part) {
      std::vector<float> front_shares;
      if (options_.borders.trim > 0 && !state_.report.is_skipped) {
        energy_->SetLevel(0);
        energy_->SetViews(state_.views);
        energy_->Visibility({});  // before others take memory
        front_shares = FrontShares(*energy_->Visibility(state_.mesh));
      }
      FinishRefinement(options_, hooks_.progress, front_shares, &state_);
    }
    return std::move(state_);
  }

 private:
  // Whether the level is complete; else the surface is of no use.
  bool RefineAtLevel(int level) {
    energy_->SetLevel(level);
    energy_->SetViews(state_.views);
    RemoveSelfIntersections(hooks_.progress, &state_);
    const std::vector<View> views = ViewsAtLevel(state_.views, level);
    FacetLabels labels = Prepare(level, views);
    const std::string stage = "Refining, level " + std::to_string(level);
    Report(hooks_.progress, stage, 0);
    ReturnFreedMemory();
    const auto on_step = [&](const RefinementStep& step,
                             const TriangleMesh& mesh) {
      state_.mesh.vertices = mesh.vertices;
      Report(hooks_.progress, stage,
             std::min(1.0, static_cast<double>(step.iteration) /
                               options_.iterations));
      return AddStep(step);
    };
    RefinedLevel refined =
        RefineLevel(options_,
                    {level, std::move(labels), views, state_.origins,
                     FixedOf(state_.fixed_sources)},
                    state_.mesh, energy_, on_step);
    state_.mesh = std::move(refined.mesh);
    if (level == 0) {
      state_.attributes.confidences =
          RefinedConfidences(state_.mesh, refined.terms, options_.photometric,
                             ConfidencesByPoints());
    }
    if (level == 0 && options_.remeshing && !refined.is_stopped) {
      RemoveSelfIntersections(hooks_.progress, &state_);
      ImproveFacets(&state_);
    }
    return !refined.is_stopped;
  }

  // Adds a step to the report, and calls the hooks.
  // \return whether to continue.
  bool AddStep(RefinementStep step) {
    step.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_)
            .count();
    state_.report.steps.push_back(step);
    if (hooks_.on_step) {
      hooks_.on_step(step, state_);
    }
    return !(hooks_.should_stop && hooks_.should_stop());
  }

  // [V] of the surface without the images: by the points, if they can tell, and
  // no more than the input's.
  std::vector<float> ConfidencesByPoints() const {
    std::vector<float> before = state_.attributes.confidences;
    if (!has_fused_points_) {
      before.resize(state_.mesh.vertices.size(), 0);
      return before;
    }
    std::vector<float> confidences = PointConfidences(
        state_.mesh, state_.attributes.views, points_, state_.views);
    for (size_t i = 0; i < before.size(); ++i) {
      confidences[i] = std::min(confidences[i], before[i]);
    }
    return confidences;
  }

  // Aligns the cameras, unless an earlier run has, and decides which views
  // refine the surface if they are fixed.
  // \return whether there are such views.
  bool AreCamerasUsable() {
    const auto cameras = std::exchange(cameras_, nullptr);  // freed afterwards
    if (!cameras) {
      return true;
    }
    state_.alignment =
        alignment_ ? std::move(*alignment_)
                   : AlignCameras(options_, *cameras, state_.mesh, points_,
                                  energy_, hooks_, &state_.views);
    if (options_.cameras.parts != RefinedParts::kNothing) {
      cameras->images->CorrectLenses(
          state_.alignment.misalignment.radial_shifts);
      return true;
    }
    // Multiple of the usual error above which a view does harm, a choice.
    constexpr double kOutlier = 3;
    const Misalignment& misalignment = state_.alignment.misalignment;
    const std::vector<uint32_t> outliers =
        MisalignedViews(misalignment, kOutlier);
    std::erase_if(pairs_, [&](const ViewPair& pair) {
      return std::ranges::binary_search(outliers, pair.first) ||
             std::ranges::binary_search(outliers, pair.second);
    });
    return misalignment.by_cameras <= misalignment.of_surface &&
           !pairs_.empty();
  }

  // Gives the mesh facets of the size that the images call for, and labels
  // them. The last buffers serve the labelling, and the energy's first
  // Render().
  // \return all labels; the state has the best ones alone.
  FacetLabels Prepare(int level, const std::vector<View>& views) {
    // Not at the coarse levels: their images show less than the mesh holds, and
    // remeshing would lose it.
    const bool is_remeshed = options_.remeshing && level == 0;
    Report(hooks_.progress, is_remeshed ? "Remeshing" : "Subdividing facets",
           0);
    const auto draw = [this](const TriangleMesh& mesh) {
      return energy_->Visibility(mesh);
    };
    FacetVisibility visibility =
        (is_remeshed ? RemeshForImages : SubdivideLargeFacets)(
            options_.max_face_area, draw, &state_);
    if (RemoveSelfIntersections(hooks_.progress, &state_)) {
      visibility = FindVisibleFacets(*draw(state_.mesh));
    }
    // Fixed facets are not refined; they are hidden from all views.
    const FixedVertices fixed = FixedOf(state_.fixed_sources);
    EditRows(
        [&](size_t facet, auto row) {
          return std::optional(
              IsFixed(fixed, state_.mesh.facets[facet]) ? 0 : row.size());
        },
        &visibility);
    Report(hooks_.progress, "Labelling facets", 0);
    FacetLabelingOptions options = options_.labeling;
    if (level > 0) {
      options.final_pairs_per_facet = 0;  // the finest level alone has them
    }
    FacetLabeling labeling = LabelFacets(
        options, state_.mesh, state_.attributes, pairs_, visibility, views);
    labeling.level = level;
    state_.report.labelings.push_back(labeling);
    state_.labels = labeling.labels.Truncated(1);
    return std::move(labeling.labels);
  }

  FacetwiseRefinementOptions options_;
  const PointCloud& points_;
  bool has_fused_points_;
  std::shared_ptr<const RefinableCameras> cameras_;  // none: as they are
  std::optional<CameraAlignment> alignment_;         // of an earlier run
  std::vector<ViewPair> pairs_;
  PhotometricEnergy* energy_;
  const RefinementHooks& hooks_;
  std::chrono::steady_clock::time_point start_ =
      std::chrono::steady_clock::now();
  RefinedMesh state_;  // of the last step
};

}  // namespace

CameraAlignment AlignCameras(const FacetwiseRefinementOptions& options,
                             const RefinableCameras& cameras,
                             const TriangleMesh& mesh, const PointCloud& points,
                             PhotometricEnergy* energy,
                             const RefinementHooks& hooks,
                             std::vector<View>* views) {
  // Of each view: more than to refine the surface, as many images together fix
  // a pose. A choice.
  constexpr int kPartners = 12;
  // Half the size: fine enough to measure, and a quarter of the work.
  constexpr int kMeasuredLevel = 1;
  const CameraRefinementOptions& method = options.cameras;
  const std::vector<ViewPair> pairs =
      SelectViewPairs(points, views->size(), kPartners);
  const auto draw = [&](int level) {
    energy->SetLevel(level);
    energy->SetViews(*views);
    return energy->Visibility(mesh);
  };
  const auto input = [&](const VisibilityBuffers& buffers) {
    return CameraInput{options.photometric, cameras.tracks, buffers, pairs,
                       cameras.images.get()};
  };
  CameraAlignment alignment;
  Misalignment& misalignment = alignment.misalignment;
  Report(hooks.progress, "Measuring the images' alignment", 0);
  CameraSet current = cameras;
  current.views = *views;
  misalignment =
      MeasureMisalignment(method, input(*draw(kMeasuredLevel)), current);
  if (method.parts == RefinedParts::kNothing) {
    return alignment;
  }
  cameras.images->CorrectLenses(misalignment.radial_shifts);
  const bool is_needed = !method.only_if_misaligned || misalignment.IsLarge() ||
                         !MisalignedViews(misalignment).empty() ||
                         !misalignment.radial_shifts.empty();
  // Coarse images are for motions that windows of finer ones do not reach.
  int level = options.levels - 1;
  while (level > 0 && misalignment.motion <= 1 << (level - 1)) {
    --level;
  }
  for (; is_needed && level >= 0; --level) {
    Report(hooks.progress, "Refining the cameras", 0);
    RefinedCameras refined =
        RefineCameras(method, input(*draw(level)), cameras, std::move(current));
    current = std::move(refined.cameras);
    *views = current.views;
    alignment.track_positions = std::move(refined.positions);
    if (hooks.on_cameras) {
      hooks.on_cameras(refined.report);
    }
    alignment.refinements.push_back(std::move(refined.report));
  }
  return alignment;
}

RefinedMesh RefineFacetwise(const FacetwiseRefinementOptions& options,
                            RefinementStart start,
                            const std::vector<View>& views,
                            const PointCloud& points, PhotometricEnergy* energy,
                            const RefinementHooks& hooks) {
  Report(hooks.progress, "Selecting pairs of views", 0);
  const int first_level = start.first_level;
  const bool is_part = start.is_part;
  return Refinement(options, std::move(start), views, points, energy, hooks)
      .Run(first_level, is_part);
}

}  // namespace colmap_ext
