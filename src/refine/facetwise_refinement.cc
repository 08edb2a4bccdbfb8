#include "refine/facetwise_refinement.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/indices.h"
#include "base/rows.h"
#include "mesh/adjacency.h"
#include "mesh/clip_mesh.h"
#include "mesh/confidences.h"
#include "mesh/normals.h"
#include "raster/visibility_buffers.h"
#include "refine/facet_sizes.h"
#include "refine/level_refinement.h"
#include "refine/refined_confidences.h"
#include "remesh/isotropic_remeshing.h"
#include "repair/self_intersection_repair.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {

void ImproveFacets(RefinedMesh* state) {
  // Choices; 2 rings are what a flip and a step of a vertex change.
  constexpr int kMaxTrials = 4;
  constexpr int kRings = 2;
  const FixedVertices fixed = FixedOf(state->fixed_sources);
  FixedVertices is_left_alone = fixed;
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    RemeshedSurface improved = ImproveAngles(state->mesh, is_left_alone);
    for (uint32_t& source : improved.fixed_sources) {
      source = source != kNone && IsFixed(fixed, source) ? source : kNone;
    }
    const size_t num_crossing =
        RepairSelfIntersections(&improved.mesh, FixedOf(improved.fixed_sources))
            .num_after;
    if (num_crossing <= state->report.num_self_intersections) {
      state->report.num_self_intersections = num_crossing;
      state->labels = state->labels.Remapped(improved.facet_sources);
      BecomeRemeshed(std::move(improved), state);
      return;
    }
    // The surroundings of what crosses are left as they are.
    std::vector<uint32_t> crossing;
    for (const FacetPair& pair : FindSelfIntersections(improved.mesh)) {
      for (const uint32_t facet : pair) {
        crossing.push_back(improved.facet_sources[facet]);
      }
    }
    is_left_alone.resize(state->mesh.vertices.size(), 0);
    const std::vector<uint32_t> around =
        Marked(MarkAround(state->mesh, crossing, kRings));
    for (const uint32_t vertex : VerticesOf(state->mesh, around)) {
      is_left_alone[vertex] = 1;
    }
  }
}

void CountSelfIntersections(const Progress& progress, RefinedMesh* state) {
  Report(progress, "Looking for self-intersections", 0);
  state->report.num_self_intersections =
      FindSelfIntersections(state->mesh).size();
}

bool RemoveSelfIntersections(const Progress& progress, RefinedMesh* state) {
  Report(progress, "Repairing self-intersections", 0);
  const SelfIntersectionRepair repair =
      RepairSelfIntersections(&state->mesh, FixedOf(state->fixed_sources));
  state->report.num_removed_self_intersections +=
      repair.num_before - repair.num_after;
  state->report.num_self_intersections = repair.num_after;
  return repair.num_after < repair.num_before;
}

void FinishRefinement(const FacetwiseRefinementOptions& options,
                      const Progress& progress, RefinedMesh* refined) {
  RefinementReport& report = refined->report;
  if (report.is_skipped) {
    CountSelfIntersections(progress, refined);
  } else {
    Report(progress, "Finishing the borders", 0);
    const Provenance from = TrimAndCloseHoles(
        options.borders,
        MeanOfCorners(refined->mesh.facets, refined->attributes.confidences),
        refined->views, refined, &report.borders);
    refined->labels = refined->labels.Remapped(from.facets);
    RemoveSelfIntersections(progress, refined);
    report.num_removed_self_intersections += report.num_self_intersections;
    refined->labels = refined->labels.Remapped(
        FinishRepair(&report.num_self_intersections, refined).facets);
    report.num_removed_self_intersections -= report.num_self_intersections;
    Unfold(&refined->mesh, FixedOf(refined->fixed_sources));
  }
  bool have_changed =
      report.borders.trim.num_facets > 0 || report.borders.holes.num_closed > 0;
  if (options.region) {
    if (const auto from = CutOff(*options.region, refined)) {
      refined->labels = refined->labels.Remapped(from->facets);
      have_changed = true;
    }
    if (refined->mesh.facets.empty()) {
      throw std::invalid_argument(
          "no face of the refined mesh lies in the region: take a larger one");
    }
  }
  if (options.remeshing && have_changed && !report.is_skipped) {
    ImproveFacets(refined);
  }
}

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
        camera_pairs_(
            cameras_ ? SelectViewPairs(points, views.size(), kCameraPartners)
                     : std::vector<ViewPair>()),
        are_cameras_refined_(cameras_ &&
                             options.cameras.parts != RefinedParts::kNothing),
        pairs_(SelectViewPairs(points, views.size(), options.pairs_per_image)),
        energy_(energy),
        hooks_(hooks) {
    if (start.origins.empty()) {
      start.origins = start.mesh.vertices;
    }
    static_cast<Surface&>(state_) = std::move(static_cast<Surface&>(start));
    state_.views = views;
    state_.report.misalignment = std::move(start.misalignment);
  }

  RefinedMesh Run(int first_level, bool is_part) {
    if (!DecideByAlignment()) {
      state_.report.is_skipped = true;
      state_.labels.labels = Rows<uint32_t>(state_.mesh.facets.size());
      first_level = -1;
    }
    for (int level = first_level; level >= 0; --level) {
      RefinedMesh complete = state_;
      if (!RefineAtLevel(level)) {
        complete.report = std::move(state_.report);
        complete.report.is_stopped = true;
        CountSelfIntersections(hooks_.progress, &complete);
        return complete;
      }
      if (hooks_.on_level) {
        hooks_.on_level(level, state_);
      }
    }
    if (!is_part) {
      FinishRefinement(options_, hooks_.progress, &state_);
    }
    return std::move(state_);
  }

 private:
  // Of each view that may be compared with it to refine the cameras: more than
  // to refine the surface, as many images together fix a pose. A choice.
  static constexpr int kCameraPartners = 12;

  // Whether the level is complete; else the surface is of no use.
  bool RefineAtLevel(int level) {
    energy_->SetLevel(level);
    energy_->SetViews(state_.views);
    RemoveSelfIntersections(hooks_.progress, &state_);
    UpdateCameras(state_.mesh);
    const std::vector<View> views = ViewsAtLevel(state_.views, level);
    Prepare(level, views);
    const std::string stage = "Refining, level " + std::to_string(level);
    Report(hooks_.progress, stage, 0);
    const std::vector<Eigen::Vector3f> before = state_.mesh.vertices;
    const auto on_step = [&](const RefinementStep& step,
                             const TriangleMesh& mesh) {
      state_.mesh.vertices = mesh.vertices;
      Report(hooks_.progress, stage,
             std::min(1.0, static_cast<double>(step.iteration) /
                               options_.iterations));
      return AddStep(step);
    };
    const auto update_cameras = [&](const TriangleMesh& mesh) {
      return level == 0 && UpdateCameras(mesh);
    };
    RefinedLevel refined =
        RefineLevel(options_,
                    {level, state_.labels, views, state_.origins,
                     update_cameras, FixedOf(state_.fixed_sources)},
                    state_.mesh, energy_, on_step);
    state_.mesh = std::move(refined.mesh);
    if (level == 0) {
      state_.attributes.confidences =
          RefinedConfidences(state_.mesh, refined.terms, options_.photometric,
                             ConfidencesByPoints());
    }
    RefinementReport& report = state_.report;
    report.num_shortened_steps += refined.num_shortened_steps;
    report.num_unconverged_solutions += refined.num_unconverged_solutions;
    report.num_flipped_facets +=
        CountFlippedFacets(state_.mesh.facets, before, state_.mesh.vertices);
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

  // Decides whether the cameras are refined, if that depends on their
  // alignment, and which views refine the surface if the cameras are fixed.
  // The report may have the measurement of an earlier run.
  // \return whether there are such views.
  bool DecideByAlignment() {
    const CameraRefinementOptions& cameras = options_.cameras;
    const bool are_fixed = cameras.parts == RefinedParts::kNothing;
    if (!cameras_ || !(are_fixed || cameras.only_if_misaligned)) {
      return true;
    }
    if (!state_.report.misalignment) {
      state_.report.misalignment = FindMisalignment();
    }
    // Share of the surface's error above which the cameras are refined;
    // multiple of the usual error above which a view does harm: choices.
    constexpr double kMinShare = 0.5;
    constexpr double kOutlier = 3;
    const Misalignment& misalignment = *state_.report.misalignment;
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

  // What the cameras are refined by.
  CameraInput InputOfCameras(const VisibilityBuffers& buffers) const {
    return {options_.photometric, cameras_->tracks, buffers, camera_pairs_,
            cameras_->images.get()};
  }

  Misalignment FindMisalignment() const {
    // Half the size: fine enough, and a quarter of the work.
    constexpr int kLevel = 1;
    Report(hooks_.progress, "Measuring the images' alignment", 0);
    energy_->SetLevel(kLevel);
    energy_->SetViews(state_.views);
    return MeasureMisalignment(
        options_.cameras, InputOfCameras(*energy_->Visibility(state_.mesh)),
        {state_.views, cameras_->view_cameras});
  }

  // Refines the cameras, if that is to be, and passes them on.
  // \return whether any image moved by so much that the surface has to follow
  bool UpdateCameras(const TriangleMesh& mesh) {
    if (!are_cameras_refined_) {
      return false;
    }
    // Px of the level; a tenth of what a step of the surface is about.
    constexpr double kMinMotion = 0.01;
    Report(hooks_.progress, "Refining the cameras", 0);
    RefinedCameras refined = RefineCameras(
        options_.cameras, InputOfCameras(*energy_->Visibility(mesh)),
        {cameras_->views, cameras_->view_cameras},
        {state_.views, cameras_->view_cameras});
    state_.views = std::move(refined.cameras.views);
    state_.track_positions = std::move(refined.positions);
    energy_->SetViews(state_.views);
    if (hooks_.on_cameras) {
      hooks_.on_cameras(refined.report);
    }
    state_.report.cameras.push_back(std::move(refined.report));
    return state_.report.cameras.back().total_motion > kMinMotion;
  }

  // Gives the mesh facets of the size that the images call for, and labels
  // them. The last buffers serve the labelling, and the energy's first
  // Render().
  void Prepare(int level, const std::vector<View>& views) {
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
    state_.labels = std::move(labeling.labels);
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
  RefinedMesh state_;  // of the last step
};

}  // namespace

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
