#include "labeling/candidate_pairs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "raster/facet_frames.h"

namespace colmap_ext {

namespace {

// Information of view j on the facet's position, beside i: pixels in i times
// the squared motion in j (px) for a unit motion along the normal, for a facet
// of unit area (docs/method.md, section 4.3). The number of pixels is low by
// the cosine of the angle between the ray and the axis of i: exact is |n . ray|
// fx fy / z^3. 0 where the facet's corner lies behind a view.
double Information(const FacetFrame& frame, const View& i, const View& j) {
  const Eigen::Vector3d ray = frame.corner - i.Center();
  const double distance = frame.normal.dot(ray);
  const double depth = i.CamFromWorld(frame.corner).z();
  const Eigen::Vector3d in_j = j.CamFromWorld(frame.corner);
  if (!(depth > 0 && in_j.z() > 0)) {
    return 0;
  }
  const double pixels =
      std::abs(distance) / ray.norm() * i.fx * i.fy / (depth * depth);
  const Eigen::Vector3d ray_in_j = j.cam_from_world_rotation * ray;
  const Eigen::Vector2d disparity =
      Eigen::Vector2d(
          j.fx * (ray_in_j.x() - ray_in_j.z() * in_j.x() / in_j.z()),
          j.fy * (ray_in_j.y() - ray_in_j.z() * in_j.y() / in_j.z())) /
      (in_j.z() * distance);
  return pixels * disparity.squaredNorm();
}

}  // namespace

CandidatePairs::CandidatePairs(const TriangleMesh& mesh,
                               const VertexAttributes& attributes,
                               const std::vector<ViewPair>& pairs,
                               const FacetVisibility& visibility,
                               const std::vector<View>& views,
                               PairSelection selection)
    : selection_(selection),
      mesh_(mesh),
      views_(views),
      attributes_(attributes),
      pairs_(pairs),
      visibility_(visibility),
      pairs_of_(GroupInRows<uint32_t>(views.size(), [&](const auto& add) {
        for (uint32_t i = 0; i < pairs.size(); ++i) {
          add(pairs[i].first, i);
        }
      })) {}

CandidatePairs::Occurrences CandidatePairs::CountOccurrences(
    size_t facet) const {
  const auto seen = visibility_[facet];
  Occurrences occurrences{0, std::vector<uint32_t>(seen.size(), 0)};
  for (const uint32_t vertex : mesh_.facets[facet]) {
    const auto views = attributes_.views[vertex];
    occurrences.num_views += views.size();
    for (const uint32_t view : views) {
      const auto at = std::lower_bound(seen.begin(), seen.end(), view);
      if (at != seen.end() && *at == view) {
        ++occurrences.counts[at - seen.begin()];
      }
    }
  }
  return occurrences;
}

// The pairs of a view and the views that see the facet are both ascending: one
// pass over both finds what they have in common.
template <typename Function>
void CandidatePairs::ForEachSeeing(size_t facet,
                                   const Function& function) const {
  const auto seen = visibility_[facet];
  for (size_t i = 0; i < seen.size(); ++i) {
    size_t j = i + 1;
    for (const uint32_t pair : pairs_of_[seen[i]]) {
      while (j < seen.size() && seen[j] < pairs_[pair].second) {
        ++j;
      }
      if (j < seen.size() && seen[j] == pairs_[pair].second) {
        function(pair, i, j);
      }
    }
  }
}

std::vector<CandidatePair> CandidatePairs::Find(size_t facet) const {
  const Occurrences occurrences = CountOccurrences(facet);
  const std::vector<uint32_t>& counts = occurrences.counts;
  std::vector<CandidatePair> candidates;
  std::vector<CandidatePair> others;  // that nu_f does not have
  ForEachSeeing(facet, [&](uint32_t pair, size_t i, size_t j) {
    if (selection_ == PairSelection::kFacetwise && counts[i] > 0 &&
        counts[j] > 0) {
      const double share = static_cast<double>(counts[i] + counts[j]) /
                           static_cast<double>(occurrences.num_views);
      candidates.push_back({pair, static_cast<float>(-std::log(share))});
    } else {
      others.push_back({pair, 0});
    }
  });
  return candidates.empty() ? others : candidates;
}

void CandidatePairs::AddInformation(
    size_t facet, std::vector<CandidatePair>* candidates) const {
  // Of the best pair's. Cameras at one place have no information: they
  // cost 6.9, more than any difference of the other term, instead of infinitely
  // much.
  constexpr double kMinShare = 1e-6;
  const FacetFrame frame = ComputeFacetFrame(mesh_, mesh_.facets[facet]);
  std::vector<double> information;
  double most = 0;
  for (const CandidatePair& candidate : *candidates) {
    const auto& [a, b] = pairs_[candidate.label];
    information.push_back(Information(frame, views_[a], views_[b]) +
                          Information(frame, views_[b], views_[a]));
    most = std::max(most, information.back());
  }
  for (size_t i = 0; i < candidates->size(); ++i) {
    const double share = most > 0 ? information[i] / most : 1;
    (*candidates)[i].cost -=
        static_cast<float>(0.5 * std::log(std::max(share, kMinShare)));
  }
}

}  // namespace colmap_ext
