#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "cameras/camera_set.h"

namespace colmap_ext {

// Distance of an observation from the point's projection, px; infinite where
// the point lies behind the camera.
double ReprojectionError(const View& view, const TrackObservation& seen,
                         const Eigen::Vector3d& position);

// The longest tracks, until each view has so many observations or all of its
// own.
SparseTracks ChooseTracks(const SparseTracks& tracks, size_t num_views,
                          size_t min_observations_per_view);

// The points of the tracks where the views show them: each minimizes the robust
// sum of its squared reprojection errors, and of its squared distance from
// where it was.
// \param sigmas  [views] of an observation, px.
// \param point_sigma  of where a point was, px of the view where they are
//        largest.
// \return [P] world, scene units
std::vector<Eigen::Vector3d> LocateTracks(const SparseTracks& tracks,
                                          const std::vector<View>& views,
                                          const std::vector<double>& sigmas,
                                          double point_sigma);

}  // namespace colmap_ext
