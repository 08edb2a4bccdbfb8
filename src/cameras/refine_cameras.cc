#include "cameras/refine_cameras.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "base/percentile.h"
#include "base/rows.h"

namespace colmap_ext {
namespace {

// The covariance of a shift, px^2: the noise of the window, the sampling of the
// images, and, along the epipolar line, tilt and curvature of the surface. The
// constants are tuned on bunny (docs/results.md).
Eigen::Matrix2d Covariance(const PhotometricOptions& photometric,
                           const WindowShift& shift,
                           const ShiftJacobian& jacobian) {
  constexpr double kSampling = 0.05;
  constexpr double kTilt = 0.2;
  const double noise =
      2 * (1 + photometric.residual_floor - shift.zncc) / shift.num_pixels;
  const Eigen::Vector2d along = jacobian.by_displacement.normalized();
  return noise * shift.curvature.inverse() +
         kSampling * kSampling * Eigen::Matrix2d::Identity() +
         kTilt * kTilt * along * along.transpose();
}

// [views] Of each view's values; `otherwise` where there are fewer than
// min_count.
std::vector<double> Medians(std::vector<std::vector<double>> values,
                            double otherwise, size_t min_count = 1) {
  std::vector<double> medians;
  for (std::vector<double>& of_view : values) {
    medians.push_back(of_view.size() < min_count ? otherwise
                                                 : Median(&of_view));
  }
  return medians;
}

class CameraRefinement {
 public:
  CameraRefinement(const CameraRefinementOptions& options,
                   const CameraInput& input, const CameraSet& original,
                   CameraSet cameras)
      : options_(options),
        photometric_(input.photometric),
        original_(original),
        all_tracks_(input.tracks),
        tracks_(ChooseTracks(input.tracks, original.views.size(),
                             options.min_observations_per_view)),
        scene_{input.buffers, input.images},
        patches_(
            SelectPatches(options.patches, photometric_, scene_, input.pairs)),
        estimate_{std::move(cameras),
                  std::vector<double>(patches_.patches.size(), 0),
                  tracks_.positions} {
    report_.level = input.images->Level();
    report_.views.resize(original.views.size());
  }

  RefinedCameras Run() {
    const std::vector<View> start = estimate_.cameras.views;
    Iterate(options_.parts);
    std::vector<Eigen::Vector3d> positions =
        LocateTracks(all_tracks_, estimate_.cameras.views, TrackSigmas(),
                     options_.priors.point);
    RestoreGauge(&positions);
    const std::vector<double> motions = Motions(original_.views);
    for (size_t i = 0; i < motions.size(); ++i) {
      report_.views[i].motion = motions[i];
    }
    report_.total_motion = std::ranges::max(Motions(start)) /
                           static_cast<double>(1 << report_.level);
    return {std::move(estimate_.cameras), std::move(positions),
            std::move(report_)};
  }

  Misalignment FindMisalignment() {
    constexpr size_t kMinPatches = 8;  // of a view, a choice
    Iterate(RefinedParts::kNothing);
    const std::vector<double> fixed = estimate_.displacements;
    Iterate(RefinedParts::kPoses);
    const std::vector<double>& free = estimate_.displacements;
    std::vector<double> by_cameras;
    std::vector<double> of_surface;
    std::vector<std::vector<double>> by_view(original_.views.size());
    for (size_t i = 0; i < fixed.size(); ++i) {
      if (fixed[i] != 0 && free[i] != 0) {
        by_cameras.push_back(std::abs(fixed[i] - free[i]));
        by_view[patches_.patches[i].view].push_back(by_cameras.back());
        of_surface.push_back(std::abs(free[i]));
      }
    }
    Misalignment misalignment;
    if (!by_cameras.empty()) {
      misalignment.by_cameras = Median(&by_cameras);
      misalignment.of_surface = Median(&of_surface);
    }
    misalignment.by_view = Medians(std::move(by_view), 0, kMinPatches);
    misalignment.motion = std::ranges::max(Motions(original_.views));
    misalignment.radial_shifts = EstimateRadialShifts(
        ViewsAtLevel(estimate_.cameras.views, report_.level),
        original_.view_cameras, patches_.patches, shifts_);
    return misalignment;
  }

 private:
  // Compares windows and solves for the cameras, in turn.
  void Iterate(RefinedParts parts) {
    // Px of the level's images; a round that moves no image by more is the
    // last one.
    constexpr double kMinMotion = 0.01;
    const double scale = 1.0 / (1 << report_.level);
    for (int round = 0; round < options_.max_rounds; ++round) {
      const CameraEvidence evidence = Gather(parts);
      const std::vector<View> before = estimate_.cameras.views;
      if (!SolveCameras(evidence, original_, &estimate_)) {
        break;
      }
      shifts_ = evidence.shifts;
      ++report_.num_rounds;
      for (size_t k = 0; k < patches_.patches.size(); ++k) {
        patches_.patches[k].displacement = estimate_.displacements[k];
      }
      const std::vector<double> motions = Motions(before);
      for (size_t i = 0; i < motions.size(); ++i) {
        report_.views[i].last_motion = scale * motions[i];
      }
      if (scale * std::ranges::max(motions) < kMinMotion) {
        break;
      }
    }
  }

  // The shifts of the windows that match.
  std::vector<ShiftMeasurement> Measure(
      const std::vector<View>& views,
      const std::vector<WindowShift>& compared) const {
    const auto append = [&](size_t k, std::vector<ShiftMeasurement>* measured) {
      const SurfacePatch& patch = patches_.patches[k];
      const Eigen::Vector3d point =
          PatchPoint(views[patch.view], scene_.FrameOf(patch.facet), patch);
      for (size_t l = 0; l < patches_.partners[k].size(); ++l) {
        const WindowShift& shift = compared[patches_.partners.offsets[k] + l];
        if (!shift.is_valid || shift.zncc < options_.min_zncc ||
            !(shift.curvature.determinant() > 0)) {
          continue;
        }
        ShiftMeasurement& measurement = measured->emplace_back();
        measurement.patch = static_cast<uint32_t>(k);
        measurement.i = patch.view;
        measurement.j = patches_.partners[k][l];
        measurement.jacobian = ComputeShiftJacobian(
            views[patch.view], views[measurement.j], point, patch.normal);
        measurement.jacobian.by_displacement *= patch.footprint;
        measurement.shift = -shift.curvature.inverse() * shift.slope;
        const Eigen::Matrix2d information =
            Covariance(photometric_, shift, measurement.jacobian).inverse();
        measurement.whitening = information.llt().matrixU();
      }
    };
    return MakeRows<ShiftMeasurement>(patches_.patches.size(), append).values;
  }

  // [views] The standard deviation of the observations in each view, px: that
  // of all views, or a larger one where they do not fit, so that the view can
  // move. Points behind a camera are infinitely far off.
  std::vector<double> TrackSigmas() {
    constexpr double kMinSigma = 0.2;  // px, of features at best
    // Of two coordinates together: the median of Rayleigh's distribution.
    constexpr double kSigmaOfMedianDistance = 1 / 1.1774;
    std::vector<std::vector<double>> errors(estimate_.cameras.views.size());
    std::vector<double> all;
    for (size_t i = 0; i < tracks_.positions.size(); ++i) {
      for (const TrackObservation& seen : tracks_.observations[i]) {
        const View& view = estimate_.cameras.views[seen.view];
        const Eigen::Vector3d p = view.CamFromWorld(estimate_.positions[i]);
        const double error =
            p.z() > 0 ? (view.ImageFromCam(p) - seen.pixel).norm() : HUGE_VAL;
        errors[seen.view].push_back(error);
        all.push_back(error);
      }
    }
    report_.track_sigma =
        all.empty()
            ? kMinSigma
            : std::max(kMinSigma, kSigmaOfMedianDistance * Median(&all));
    std::vector<double> sigmas = Medians(std::move(errors), 0);
    for (double& sigma : sigmas) {
      sigma = std::max(report_.track_sigma, kSigmaOfMedianDistance * sigma);
    }
    return sigmas;
  }

  CameraEvidence Gather(RefinedParts parts) {
    const std::vector<View> views =
        ViewsAtLevel(estimate_.cameras.views, report_.level);
    const std::vector<WindowShift> compared = ComparePatches(
        photometric_, options_.patches.radius, scene_, views, patches_);
    CameraEvidence evidence{Measure(views, compared),
                            tracks_,
                            Depths(views),
                            TrackSigmas(),
                            {},
                            options_.priors,
                            parts == RefinedParts::kPosesIntrinsics};
    DropAstray(&evidence);
    CountEvidence(parts, &evidence);
    report_.num_windows = 0;
    double sum = 0;
    for (const WindowShift& shift : compared) {
      if (shift.is_valid && shift.zncc >= options_.min_zncc) {
        sum += shift.zncc;
        ++report_.num_windows;
      }
    }
    report_.mean_zncc = sum / std::max(report_.num_windows, size_t{1});
    if (report_.num_rounds == 0) {
      report_.mean_zncc_before = report_.mean_zncc;
    }
    return evidence;
  }

  // Drops the windows of views whose reprojection errors are large: their
  // matches are false and would keep the views in place.
  void DropAstray(CameraEvidence* evidence) const {
    // Multiples of the noise of all features; and px of the level, beyond which
    // windows do not match.
    constexpr double kFarOff = 3;
    constexpr double kOutOfReach = 2;
    const double limit = std::max(kFarOff * report_.track_sigma,
                                  kOutOfReach * (1 << report_.level));
    std::erase_if(evidence->shifts, [&](const ShiftMeasurement& shift) {
      return evidence->track_sigmas[shift.i] > limit ||
             evidence->track_sigmas[shift.j] > limit;
    });
  }

  // [views] Medians over the patches and the points that they see.
  std::vector<double> Depths(const std::vector<View>& views) const {
    std::vector<std::vector<double>> depths(views.size());
    for (const SurfacePatch& patch : patches_.patches) {
      depths[patch.view].push_back(patch.footprint * views[patch.view].fx);
    }
    for (size_t i = 0; i < tracks_.positions.size(); ++i) {
      for (const TrackObservation& seen : tracks_.observations[i]) {
        const double depth =
            views[seen.view].CamFromWorld(estimate_.positions[i]).z();
        if (depth > 0) {
          depths[seen.view].push_back(depth);
        }
      }
    }
    return Medians(std::move(depths), 1);
  }

  // Of each view; frames with too little are skipped.
  void CountEvidence(RefinedParts parts, CameraEvidence* evidence) {
    // A pose has 6 parameters; some times as many are needed to tell outliers.
    constexpr size_t kMinEvidence = 20;
    for (RefinedView& view : report_.views) {
      view.num_windows = 0;
      view.num_observations = 0;
    }
    for (const ShiftMeasurement& shift : evidence->shifts) {
      ++report_.views[shift.i].num_windows;
      ++report_.views[shift.j].num_windows;
    }
    for (const TrackObservation& seen : tracks_.observations.values) {
      ++report_.views[seen.view].num_observations;
    }
    std::vector<size_t> counts(report_.views.size(), 0);  // of frames
    for (size_t i = 0; i < counts.size(); ++i) {
      const RefinedView& view = report_.views[i];
      counts[original_.LeaderOf(i)] += view.num_windows + view.num_observations;
    }
    for (size_t i = 0; i < counts.size(); ++i) {
      const bool is_skipped = parts == RefinedParts::kNothing ||
                              counts[original_.LeaderOf(i)] < kMinEvidence;
      report_.views[i].is_skipped = is_skipped;
      evidence->is_skipped.push_back(is_skipped ? 1 : 0);
    }
  }

  // Aligns the world to the original points of the sparse model.
  void RestoreGauge(std::vector<Eigen::Vector3d>* positions) {
    std::vector<View>& views = estimate_.cameras.views;
    std::vector<double> footprints(positions->size(), 0);
    for (size_t i = 0; i < positions->size(); ++i) {
      for (const TrackObservation& seen : all_tracks_.observations[i]) {
        const View& view = views[seen.view];
        footprints[i] = std::max(
            footprints[i], view.CamFromWorld((*positions)[i]).z() / view.fx);
      }
    }
    const Similarity similarity =
        AlignPoints(*positions, all_tracks_.positions, footprints,
                    /*has_scale=*/original_.leaders.empty());
    if (similarity.IsIdentity()) {
      return;
    }
    for (View& view : views) {
      view = TransformView(similarity, view);
    }
    for (Eigen::Vector3d& position : *positions) {
      position = similarity(position);
    }
  }

  // [views] The median motion of the patches and points in each view, px of the
  // full-size image.
  std::vector<double> Motions(const std::vector<View>& before) const {
    const std::vector<View>& after = estimate_.cameras.views;
    std::vector<std::vector<double>> motions(before.size());
    const auto add = [&](size_t view, const Eigen::Vector3d& point) {
      const Eigen::Vector3d in_before = before[view].CamFromWorld(point);
      const Eigen::Vector3d in_after = after[view].CamFromWorld(point);
      if (in_before.z() > 0 && in_after.z() > 0) {
        motions[view].push_back((after[view].ImageFromCam(in_after) -
                                 before[view].ImageFromCam(in_before))
                                    .norm());
      }
    };
    const std::vector<View> views = ViewsAtLevel(after, report_.level);
    for (const SurfacePatch& patch : patches_.patches) {
      add(patch.view,
          PatchPoint(views[patch.view], scene_.FrameOf(patch.facet), patch));
    }
    for (size_t i = 0; i < tracks_.positions.size(); ++i) {
      for (const TrackObservation& seen : tracks_.observations[i]) {
        add(seen.view, estimate_.positions[i]);
      }
    }
    return Medians(std::move(motions), 0);
  }

  const CameraRefinementOptions& options_;
  const PhotometricOptions& photometric_;
  const CameraSet& original_;
  const SparseTracks& all_tracks_;
  SparseTracks tracks_;  // those that are used
  DrawnScene scene_;
  SurfacePatches patches_;
  CameraEstimate estimate_;
  std::vector<ShiftMeasurement> shifts_;  // of the last round
  CameraRefinementReport report_;
};

}  // namespace

RefinedCameras RefineCameras(const CameraRefinementOptions& options,
                             const CameraInput& input,
                             const CameraSet& original, CameraSet cameras) {
  return CameraRefinement(options, input, original, std::move(cameras)).Run();
}

std::vector<uint32_t> MisalignedViews(const Misalignment& misalignment,
                                      double min_share) {
  const double limit =
      std::max(misalignment.of_surface, min_share * misalignment.by_cameras);
  std::vector<uint32_t> views;
  for (size_t i = 0; i < misalignment.by_view.size(); ++i) {
    if (misalignment.by_view[i] > limit) {
      views.push_back(static_cast<uint32_t>(i));
    }
  }
  return views;
}

Misalignment MeasureMisalignment(const CameraRefinementOptions& options,
                                 const CameraInput& input,
                                 const CameraSet& cameras) {
  return CameraRefinement(options, input, cameras, cameras).FindMisalignment();
}

}  // namespace colmap_ext
