#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "cameras/refine_cameras.h"
#include "labeling/facet_labeling.h"
#include "labeling/view_pairs.h"
#include "mesh/surface.h"
#include "photometry/image_pyramid.h"
#include "photometry/photometric_energy.h"
#include "repair/borders.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"
#include "scene/region.h"
#include "scene/view.h"

namespace colmap_ext {

enum class RefinementSolver {
  kGaussNewton,  // all vertices at once, by the normal equations
  kDescent,      // along the gradient, each vertex by itself
};

struct FacetwiseRefinementOptions {
  // Image levels, coarse to fine: 3 is a quarter of the size, half, full.
  int levels = 3;

  // Maximum number of solver iterations per level, excluding the final ones.
  // Most levels end earlier (docs/method.md, section 7.3).
  int iterations = 10;

  RefinementSolver solver = RefinementSolver::kGaussNewton;

  // Factor on the weight of the smoothness that the roughness of the surface
  // itself calls for (docs/method.md, section 6.5); 0 is none.
  double smoothness_weight = 1;

  // Remesh the surface before the finest level, so that its facets are
  // well-shaped and as large as the images call for. At the other levels, or
  // without it, large facets are only subdivided.
  bool remeshing = true;

  // The area that facets get before a level starts, px^2 of the level's images,
  // in the image that shows the facet second largest: edges of four pixels, a
  // little less than a window. Without remeshing, larger facets are subdivided.
  double max_face_area = 7;

  // Facets are refined where the images agree by this correlation or more in
  // their surroundings when a level starts (ConfirmedFacets()); others follow
  // what lies around them. Of windows that show one surface most have more, of
  // others few. In [-1, 1]; -1 refines all, as in the paper.
  double min_zncc = 0.5;

  // Partners of each view, those with which it shares the most points.
  int pairs_per_image = 4;

  FacetLabelingOptions labeling;

  PhotometricOptions photometric;

  // Refinement of the cameras before that of the surface (docs/method.md,
  // section 7.7).
  CameraRefinementOptions cameras;

  // Trimming of the result, and closing of its holes. What a trimming leaves
  // open is wider than twice its gap width.
  BorderOptions borders{.close_holes = 64};

  // Parts that leave the region are clipped in the final step. nullopt: none.
  std::optional<Region> region = std::nullopt;
};

// One iteration of the solver, for the log and the report.
struct RefinementStep {
  int level = 0;          // the images are 2^level times smaller
  bool is_final = false;  // by more pairs of each facet, level_refinement.h
  size_t num_pairs = 0;   // of a facet, at most
  int iteration = 0;      // of the level, from 1. 0 is the state that it starts
                          // from, and the last number is repeated with that
                          // which iterations by more pairs start from.
  double energy = 0;      // photometric and smoothness
  double photometric_energy = 0;
  double mean_zncc = 0;  // over the pixels that are compared, weighted
  double mean_step = 0;  // of a vertex, px of the level's images
  double seconds = 0;    // since the start of the refinement
  size_t num_vertices = 0;
  size_t num_facets = 0;
};

struct RefinementReport {
  std::vector<RefinementStep> steps;
  std::vector<LabelingReport> labelings;  // one a level
  bool is_stopped = false;                // by RefinementHooks::should_stop
  bool is_skipped = false;  // not refined: the cameras are off by more
  size_t num_removed_self_intersections = 0;  // pairs of facets, of the input
                                              // and between levels
  size_t num_self_intersections = 0;          // of the result
  BorderReport borders;
};

// Input of the camera refinement: the cameras as the refinement takes them,
// before any of it.
struct RefinableCameras : CameraSet {
  SparseTracks tracks;                   // of the sparse model
  std::shared_ptr<ImagePyramid> images;  // that the energy uses
};

// How well cameras are aligned, and what was done about it.
struct CameraAlignment {
  Misalignment misalignment;                        // at the start
  std::vector<CameraRefinementReport> refinements;  // one a level, or none
  // Of the sparse model's points, by the refined views; empty if none were.
  std::vector<Eigen::Vector3d> track_positions;
  bool IsRefined() const { return !refinements.empty(); }
};

// What a refinement starts from: the input, or the result of a complete level.
// The mesh is manifold. Its vertices may have no views: then a facet may take
// all pairs that see it. Without origins the vertices are the origins. Facets
// between fixed vertices are visible, occlude other facets and take part in the
// smoothness, but get no labels.
struct RefinementStart : Surface {
  int first_level = 0;  // below FacetwiseRefinementOptions::levels
  // Whether the points were fused from the images, so that surface without
  // points is less sure; else they only tell which views see what.
  bool has_fused_points = true;
  // The cameras as they are now are the views that are passed beside.
  // options.cameras says whether they are refined. None: nothing is known.
  std::shared_ptr<const RefinableCameras> cameras = nullptr;
  // By the run that is being resumed; nullopt: a new run.
  std::optional<CameraAlignment> alignment = std::nullopt;
  // It is a part of a surface: its borders are left as they are, and
  // FinishRefinement() is called for the whole.
  bool is_part = false;
};

// Manifold; its confidences are those of RefinedConfidences() once the last
// level is complete, its fixed sources those of the start.
struct RefinedMesh : Surface {
  FacetLabels labels;         // [F] the best of the last level; none of facets
                              // that close a hole
  std::vector<View> views;    // as they were refined
  CameraAlignment alignment;  // nothing if nothing is known of the cameras
  RefinementReport report;
};

// Callbacks during a refinement; all may be empty. Called by the thread that
// called RefineFacetwise().
struct RefinementHooks {
  Progress progress;

  // After each iteration, and before the first one of a level.
  std::function<void(const RefinementStep& step, const RefinedMesh& state)>
      on_step;

  // After the cameras were refined at a level.
  std::function<void(const CameraRefinementReport& report)> on_cameras;

  // After each level, `state` as it would be returned, its borders as they
  // were.
  std::function<void(int level, const RefinedMesh& state)> on_level;

  // Called between iterations. If it returns true, the refinement ends, and of
  // its result only the report is of use.
  std::function<bool()> should_stop;
};

// Measures how well the cameras are aligned. Unless they are fixed, corrects
// errors of lenses in the images, and refines the cameras by the surface as it
// is, as options.cameras has it (docs/method.md, section 7.7).
//
// \param views [in,out] the cameras as they are now
CameraAlignment AlignCameras(const FacetwiseRefinementOptions& options,
                             const RefinableCameras& cameras,
                             const TriangleMesh& mesh, const PointCloud& points,
                             PhotometricEnergy* energy,
                             const RefinementHooks& hooks,
                             std::vector<View>* views);

// Facetwise refinement [Romanoni2020, sections II-A and V; docs/method.md,
// section 7]: at each level of the images, coarse to fine, facets are
// subdivided, each gets the pairs of views that see it best, and the vertices
// move so that what the two views of a pair show on its facets looks alike.
// Self-intersections are repaired before each level, before and after its
// facets change, and after the last one. Cameras are aligned before the first
// level. If they are given but not refined, views whose error is so large that
// the surface would get worse are left out; if most views are, the mesh is only
// clipped to the region (docs/method.md, section 7.7).
//
// \param views  the cameras as they are now.
// \param points  whose views tell which views have most in common.
// \pre options in their ranges
// \throw std::invalid_argument if the trimming or the region leaves nothing.
RefinedMesh RefineFacetwise(const FacetwiseRefinementOptions& options,
                            RefinementStart start,
                            const std::vector<View>& views,
                            const PointCloud& points, PhotometricEnergy* energy,
                            const RefinementHooks& hooks);

// Gives thin facets, which steps along the normals leave, a better shape,
// except where that makes facets cross.
void ImproveFacets(RefinedMesh* state);

// Counts self-intersections in the report.
void CountSelfIntersections(const Progress& progress, RefinedMesh* state);

// Repairs self-intersections, and counts them in the report.
// \return whether the mesh is another one now
bool RemoveSelfIntersections(const Progress& progress, RefinedMesh* state);

// What follows the last level: the borders are trimmed and closed, what lies
// outside of the region is cut off, self-intersections are repaired. Of a mesh
// that was not refined (RefinementReport::is_skipped) only the second.
// \param front_shares [F] see TrimMesh()
// \throw std::invalid_argument if the trimming or the region leaves nothing.
void FinishRefinement(const FacetwiseRefinementOptions& options,
                      const Progress& progress,
                      const std::vector<float>& front_shares,
                      RefinedMesh* refined);

}  // namespace colmap_ext
