#include "refine/facetwise_refinement.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "base/rows.h"
#include "labeling/view_pairs.h"
#include "mesh/normals.h"
#include "photometry/image_pyramid.h"
#include "raster/visibility_buffers.h"
#include "refine/facet_sizes.h"
#include "refine/level_refinement.h"
#include "refine/refined_confidences.h"

namespace colmap_ext {

namespace {

// Fixed facets are not refined; they are hidden from all views.
void HideFixed(const RefinedMesh& state, FacetVisibility* visibility) {
  const FixedVertices fixed = FixedOf(state.fixed_sources);
  EditRows(
      [&](size_t facet, auto row) {
        return std::optional(
            IsFixed(fixed, state.mesh.facets[facet]) ? 0 : row.size());
      },
      visibility);
}

class Refinement {
 public:
  Refinement(const FacetwiseRefinementOptions& options,
             const std::vector<View>& views, const PointCloud& points,
             bool has_fused_points, PhotometricEnergy* energy,
             const RefinementHooks& hooks,
             std::shared_ptr<const RefinableCameras> cameras)
      : options_(options),
        points_(points),
        has_fused_points_(has_fused_points),
        cameras_(std::move(cameras)),
        camera_pairs_(
            cameras_ ? SelectViewPairs(points, views.size(), kCameraPartners)
                     : std::vector<ViewPair>()),
        are_cameras_refined_(cameras_ &&
                             options.cameras.parts != RefinedParts::kNothing),
        pairs_(SelectViewPairs(points, views.size(), options.pairs_per_image)),
        energy_(energy),
        hooks_(hooks) {}

  // Whether the level is complete; else `state` is of no use.
  bool RefineAtLevel(int level, RefinedMesh* state) {
    energy_->SetLevel(level);
    energy_->SetViews(state->views);
    RemoveSelfIntersections(hooks_.progress, state);
    RefineViews(state->mesh, state);
    std::vector<View> views;
    for (const View& view : state->views) {
      views.push_back(ViewAtLevel(view, level));
    }
    Prepare(level, views, state);
    const std::string stage = "Refining, level " + std::to_string(level);
    Report(hooks_.progress, stage, 0);
    const std::vector<Eigen::Vector3f> before = state->mesh.vertices;
    const auto on_step = [&](RefinementStep step, const TriangleMesh& mesh) {
      state->mesh.vertices = mesh.vertices;
      Report(hooks_.progress, stage,
             std::min(1.0, static_cast<double>(step.iteration) /
                               options_.iterations));
      return AddStep(step, state);
    };
    const auto move_cameras = [&](const TriangleMesh& mesh) {
      return level == 0 && RefineViews(mesh, state);
    };
    RefinedLevel refined =
        RefineLevel(options_,
                    {level, state->labels, views, state->origins, move_cameras,
                     FixedOf(state->fixed_sources)},
                    state->mesh, energy_, on_step);
    state->mesh = std::move(refined.mesh);
    if (level == 0) {
      state->attributes.confidences =
          RefinedConfidences(state->mesh, refined.terms, options_.photometric,
                             ConfidencesByPoints(*state));
    }
    Count(refined, before, state);
    if (level == 0 && options_.remeshing && !refined.is_stopped) {
      RemoveSelfIntersections(hooks_.progress, state);
      ImproveFacets(state);
    }
    return !refined.is_stopped;
  }

  // Adds a step to the report, and calls the hooks.
  // \return whether to continue.
  bool AddStep(RefinementStep step, RefinedMesh* state) const {
    step.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_)
            .count();
    state->report.steps.push_back(step);
    if (hooks_.on_step) {
      hooks_.on_step(step, *state);
    }
    return !(hooks_.should_stop && hooks_.should_stop());
  }

  // Adds what became of a level to the report.
  // \param before [V] where the vertices were
  static void Count(const RefinedLevel& level,
                    const std::vector<Eigen::Vector3f>& before,
                    RefinedMesh* state) {
    RefinementReport& report = state->report;
    report.num_shortened_steps += level.num_shortened_steps;
    report.num_unconverged_solutions += level.num_unconverged_solutions;
    report.num_flipped_facets +=
        CountFlippedFacets(state->mesh.facets, before, state->mesh.vertices);
  }

  // [V] of the surface without the images: by the points, if they can tell, and
  // no more than the input's.
  std::vector<float> ConfidencesByPoints(const RefinedMesh& state) const {
    std::vector<float> before = state.attributes.confidences;
    if (!has_fused_points_) {
      before.resize(state.mesh.vertices.size(), 0);
      return before;
    }
    std::vector<float> confidences = PointConfidences(
        state.mesh, state.attributes.views, points_, state.views);
    for (size_t i = 0; i < before.size(); ++i) {
      confidences[i] = std::min(confidences[i], before[i]);
    }
    return confidences;
  }

  // Decides whether the cameras are refined, if that depends on their
  // alignment, and which views refine the surface if the cameras are fixed.
  // \param state  its report may have the measurement of an earlier run.
  // \return whether there are such views.
  bool DecideByAlignment(RefinedMesh* state) {
    const CameraRefinementOptions& cameras = options_.cameras;
    const bool are_fixed = cameras.parts == RefinedParts::kNothing;
    if (!cameras_ || !(are_fixed || cameras.only_if_misaligned)) {
      return true;
    }
    if (!state->report.misalignment) {
      state->report.misalignment = FindMisalignment(*state);
    }
    // Share of the surface's error above which the cameras are refined;
    // multiple of the usual error above which a view does harm: choices.
    constexpr double kMinShare = 0.5;
    constexpr double kOutlier = 3;
    const Misalignment& misalignment = *state->report.misalignment;
    if (!are_fixed) {
      are_cameras_refined_ =
          !MisalignedViews(misalignment).empty() ||
          misalignment.by_cameras > kMinShare * misalignment.of_surface;
      return true;
    }
    if (misalignment.by_cameras > kMinShare * misalignment.of_surface) {
      AverageOverPairs();
    }
    const std::vector<uint32_t> outliers =
        MisalignedViews(misalignment, kOutlier);
    std::erase_if(pairs_, [&](const ViewPair& pair) {
      return std::ranges::binary_search(outliers, pair.first) ||
             std::ranges::binary_search(outliers, pair.second);
    });
    return misalignment.by_cameras <= misalignment.of_surface &&
           !pairs_.empty();
  }

 private:
  // Of each view that may be compared with it to refine the cameras: more than
  // to refine the surface, as many images together fix a pose. A choice.
  static constexpr int kCameraPartners = 12;

  // Has more pairs refine each facet, so that the errors of poses average out.
  // Tuned on the disturbed scenes of docs/experiments.md.
  void AverageOverPairs() {
    constexpr int kPairs = 4;
    constexpr int kFinalPairs = 24;
    FacetLabelingOptions& labeling = options_.labeling;
    labeling.pairs_per_facet = std::max(labeling.pairs_per_facet, kPairs);
    if (labeling.final_pairs_per_facet > 0) {
      labeling.final_pairs_per_facet =
          std::max(labeling.final_pairs_per_facet, kFinalPairs);
    }
  }

  Misalignment FindMisalignment(const RefinedMesh& state) const {
    // Half the size: fine enough, and a quarter of the work.
    constexpr int kLevel = 1;
    Report(hooks_.progress, "Measuring the images' alignment", 0);
    energy_->SetLevel(kLevel);
    energy_->SetViews(state.views);
    return MeasureMisalignment(options_.cameras,
                               {options_.photometric, cameras_->tracks,
                                *energy_->Visibility(state.mesh), camera_pairs_,
                                cameras_->images.get()},
                               {state.views, cameras_->view_cameras});
  }

  // Refines the cameras, if that is to be, and passes them on.
  // \return whether any image moved by so much that the surface has to follow
  bool RefineViews(const TriangleMesh& mesh, RefinedMesh* state) {
    if (!are_cameras_refined_) {
      return false;
    }
    // Px of the level; a tenth of what a step of the surface is about.
    constexpr double kMinMotion = 0.01;
    Report(hooks_.progress, "Refining the cameras", 0);
    RefinedCameras refined = RefineCameras(
        options_.cameras,
        {options_.photometric, cameras_->tracks, *energy_->Visibility(mesh),
         camera_pairs_, cameras_->images.get()},
        {cameras_->views, cameras_->view_cameras},
        {state->views, cameras_->view_cameras});
    state->views = std::move(refined.cameras.views);
    state->track_positions = std::move(refined.positions);
    energy_->SetViews(state->views);
    if (hooks_.on_cameras) {
      hooks_.on_cameras(refined.report);
    }
    state->report.cameras.push_back(std::move(refined.report));
    return state->report.cameras.back().total_motion > kMinMotion;
  }

  // Gives the mesh facets of the size that the images call for, and labels
  // them. The last buffers serve the labelling, and the energy's first
  // Render().
  void Prepare(int level, const std::vector<View>& views, RefinedMesh* state) {
    // Not at the coarse levels: their images show less than the mesh holds, and
    // remeshing would lose it.
    const bool is_remeshed = options_.remeshing && level == 0;
    Report(hooks_.progress, is_remeshed ? "Remeshing" : "Subdividing facets",
           0);
    const auto draw = [this](const TriangleMesh& mesh) {
      return energy_->Visibility(mesh);
    };
    FacetVisibility visibility =
        is_remeshed ? RemeshForImages(options_.max_face_area, draw, state)
                    : SubdivideLargeFacets(options_.max_face_area, draw, state);
    if (RemoveSelfIntersections(hooks_.progress, state)) {
      visibility = FindVisibleFacets(*draw(state->mesh));
    }
    HideFixed(*state, &visibility);
    Report(hooks_.progress, "Labelling facets", 0);
    FacetLabelingOptions options = options_.labeling;
    if (level > 0) {
      options.final_pairs_per_facet = 0;  // the finest level alone has them
    }
    FacetLabeling labeling = LabelFacets(
        options, state->mesh, state->attributes, pairs_, visibility, views);
    state->report.labelings.push_back(
        {level, pairs_.size(), labeling.num_unlabeled_facets,
         labeling.initial_energy, labeling.final_energy, labeling.lower_bound});
    state->labels = std::move(labeling.labels);
  }

  FacetwiseRefinementOptions options_;
  const PointCloud& points_;
  bool has_fused_points_;
  std::shared_ptr<const RefinableCameras> cameras_;  // none: not refined
  std::vector<ViewPair> camera_pairs_;
  bool are_cameras_refined_;
  std::vector<ViewPair> pairs_;
  PhotometricEnergy* energy_;
  const RefinementHooks& hooks_;
  std::chrono::steady_clock::time_point start_ =
      std::chrono::steady_clock::now();
};

}  // namespace

RefinedMesh RefineFacetwise(const FacetwiseRefinementOptions& options,
                            RefinementStart start,
                            const std::vector<View>& views,
                            const PointCloud& points, PhotometricEnergy* energy,
                            const RefinementHooks& hooks) {
  Report(hooks.progress, "Selecting pairs of views", 0);
  Refinement refinement(options, views, points, start.has_fused_points, energy,
                        hooks, start.cameras);
  if (start.origins.empty()) {
    start.origins = start.mesh.vertices;
  }
  RefinedMesh complete;
  static_cast<Surface&>(complete) = std::move(static_cast<Surface&>(start));
  complete.views = views;
  complete.report.misalignment = std::move(start.misalignment);
  if (!refinement.DecideByAlignment(&complete)) {
    complete.report.is_skipped = true;
    complete.labels.labels = Rows<uint32_t>(complete.mesh.facets.size());
    start.first_level = -1;
  }
  for (int level = start.first_level; level >= 0; --level) {
    RefinedMesh state = complete;
    if (!refinement.RefineAtLevel(level, &state)) {
      complete.report = std::move(state.report);
      complete.report.is_stopped = true;
      break;
    }
    complete = std::move(state);
    if (hooks.on_level) {
      hooks.on_level(level, complete);
    }
  }
  if (complete.report.is_stopped) {
    CountSelfIntersections(hooks.progress, &complete);
  } else if (!start.is_part) {
    FinishRefinement(options, hooks.progress, &complete);
  }
  return complete;
}

}  // namespace colmap_ext
