#include "evaluation/mesh_evaluation.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "base/percentile.h"
#include "spatial/bvh.h"

namespace colmap_ext {

namespace {

using Points = std::vector<Eigen::Vector3f>;

// Fractions of the diagonal of the truth's bounding box, chosen by hand close
// to DTU's 20 mm and 0.2 mm.
constexpr double kMaxDistanceShare = 0.05;
constexpr double kSpacingShare = 0.001;

struct Samples {
  Points mesh;
  Points truth;
};

double Diagonal(const Points& points) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : points) {
    box.extend(point);
  }
  return box.isEmpty() ? 0 : box.diagonal().cast<double>().norm();
}

void Append(const Points& points, Points* all) {
  all->insert(all->end(), points.begin(), points.end());
}

// The finite facets or points. Points become facets without area, so that the
// same tree works for both.
TriangleMesh FinitePart(const TriangleMesh& surface, bool is_points) {
  TriangleMesh part;
  const auto is_finite = [](const auto& point) { return point.allFinite(); };
  if (is_points) {
    std::ranges::copy_if(surface.vertices, std::back_inserter(part.vertices),
                         is_finite);
    for (uint32_t i = 0; i < part.vertices.size(); ++i) {
      part.facets.push_back({i, i, i});
    }
    return part;
  }
  part.vertices = surface.vertices;
  std::ranges::copy_if(
      surface.facets, std::back_inserter(part.facets), [&](const Facet& facet) {
        return std::ranges::all_of(CornersOf(surface, facet), is_finite);
      });
  return part;
}

Points PointsInImages(Points points, const std::vector<View>& views) {
  std::erase_if(points, [&](const Eigen::Vector3f& point) {
    return std::ranges::none_of(views, [&](const View& view) {
      return PixelInImage(view, point.cast<double>()).has_value();
    });
  });
  return points;
}

std::vector<double> Distances(const Points& points, const Bvh& surface,
                              double max_distance) {
  std::vector<double> distances(points.size());
  tbb::parallel_for(size_t{0}, points.size(), [&](size_t i) {
    distances[i] = points[i].allFinite()
                       ? surface.Distance(points[i], max_distance)
                       : max_distance;
  });
  return distances;
}

class Evaluator {
 public:
  Evaluator(const MeshEvaluationOptions& options, const TriangleMesh& mesh,
            const Truth& truth, const std::vector<View>& views,
            const Observability& observability, const Progress& progress)
      : options_(options),
        truth_(truth),
        views_(views),
        observability_(observability),
        progress_(progress),
        mesh_(FinitePart(mesh, false)),
        surface_(FinitePart(truth.surface, truth.IsPoints())) {
    Report(progress_, "Building trees", 0);
    mesh_tree_.emplace(mesh_);
    truth_tree_.emplace(surface_);
  }

  MeshEvaluation Evaluate(const TriangleMesh& mesh) {
    evaluation_.topology = Analyze(mesh);
    evaluation_.num_dropped_facets = mesh.facets.size() - mesh_.facets.size();
    evaluation_.num_views = views_.size();
    Samples samples;
    if (!views_.empty()) {
      CastViews(&samples);
    }
    if (!truth_.depth_maps) {
      MeasureDistances(std::move(samples));
    }
    return evaluation_;
  }

 private:
  void CastViews(Samples* samples) {
    DepthErrors errors;
    errors.thresholds = options_.depth_thresholds;
    for (size_t i = 0; i < views_.size(); ++i) {
      Report(progress_, "Casting rays",
             static_cast<double>(i) / static_cast<double>(views_.size()));
      CastView(i, samples, &errors);
    }
    if (truth_.IsPoints()) {
      samples->truth = PointsInImages(surface_.vertices, views_);
      return;
    }
    if (errors.num_depths == 0) {
      throw std::invalid_argument(
          "no image sees the truth: are mesh, truth and workspace in the same "
          "frame?");
    }
    evaluation_.depths = errors;
  }

  void CastView(size_t index, Samples* samples, DepthErrors* errors) {
    View view = views_[index];
    DepthMap true_depths;
    if (truth_.depth_maps) {
      const DepthMap map = truth_.depth_maps(index);
      if (map.depths.empty()) {
        ++evaluation_.num_views_without_depths;
        return;
      }
      view = ResizeView(view, map.width, map.height);
      true_depths = Subsample(map, options_.stride);
    } else if (!truth_.IsPoints()) {
      true_depths = RenderDepths(*truth_tree_, view, options_.stride);
    }
    observability_.RestrictDepths(view, &true_depths);
    const DepthMap depths = RenderDepths(*mesh_tree_, view, options_.stride);
    if (truth_.IsPoints()) {
      Append(PointsWhere(depths, depths, view), &samples->mesh);
      return;
    }
    AddDepthErrors(true_depths, depths, errors);
    if (!truth_.depth_maps) {
      Append(PointsWhere(depths, true_depths, view), &samples->mesh);
      Append(PointsWhere(true_depths, true_depths, view), &samples->truth);
    }
  }

  void MeasureDistances(Samples samples) {
    const double diagonal =
        Diagonal(views_.empty() ? surface_.vertices : samples.truth);
    SurfaceDistances result;
    result.spacing =
        options_.spacing > 0 ? options_.spacing : kSpacingShare * diagonal;
    result.max_distance = options_.max_distance > 0
                              ? options_.max_distance
                              : kMaxDistanceShare * diagonal;
    if (!(result.spacing > 0 && result.max_distance > 0)) {
      throw std::invalid_argument(
          "the truth has no extent to take the spacing of the samples and the "
          "maximum distance from");
    }
    Report(progress_, "Measuring distances", 0);
    if (views_.empty()) {
      samples.mesh = SampleSurface(mesh_, result.spacing);
      samples.truth = truth_.IsPoints()
                          ? surface_.vertices
                          : SampleSurface(surface_, result.spacing);
    }
    observability_.RestrictMesh(&samples.mesh);
    observability_.RestrictTruth(&samples.truth);
    DownsampleByVoxels(result.spacing, &samples.mesh);
    DownsampleByVoxels(result.spacing, &samples.truth);
    const auto measure = [&](const Points& points, const Bvh& surface) {
      return Summarize(Distances(points, surface, result.max_distance),
                       result.max_distance, options_.drop_beyond);
    };
    result.accuracy = measure(samples.mesh, *truth_tree_);
    result.completeness = measure(samples.truth, *mesh_tree_);
    evaluation_.distances = result;
  }

  const MeshEvaluationOptions& options_;
  const Truth& truth_;
  const std::vector<View>& views_;
  const Observability& observability_;
  const Progress& progress_;
  const TriangleMesh mesh_;     // its finite part
  const TriangleMesh surface_;  // the finite part of the truth
  std::optional<Bvh> mesh_tree_;
  std::optional<Bvh> truth_tree_;
  MeshEvaluation evaluation_;
};

}  // namespace

DistanceStatistics Summarize(std::vector<double> distances, double max_distance,
                             bool drop_beyond) {
  DistanceStatistics statistics;
  statistics.num_samples = distances.size();
  std::sort(distances.begin(), distances.end());
  const auto beyond =
      std::lower_bound(distances.begin(), distances.end(), max_distance);
  statistics.num_beyond = static_cast<size_t>(distances.end() - beyond);
  if (drop_beyond) {
    distances.erase(beyond, distances.end());
  }
  if (distances.empty()) {
    statistics.mean = statistics.median = statistics.percentile90 =
        std::numeric_limits<double>::quiet_NaN();
    return statistics;
  }
  // Summed in ascending order: independent of the order of the samples.
  statistics.mean = std::accumulate(distances.begin(), distances.end(), 0.0) /
                    static_cast<double>(distances.size());
  statistics.median = Median(&distances);
  statistics.percentile90 = InterpolatedPercentile(90, &distances);
  return statistics;
}

bool ObservabilityMask::Contains(const Eigen::Vector3f& point) const {
  const Eigen::Array3d voxel =
      ((point.cast<double>() - origin) / resolution).array().round();
  size_t index = 0;
  for (int i = 0; i < 3; ++i) {
    if (!(voxel[i] >= 0 && voxel[i] < static_cast<double>(size[i]))) {
      return false;
    }
    index = index * size[i] + static_cast<size_t>(voxel[i]);
  }
  return voxels[index] != 0;
}

void Observability::RestrictMesh(std::vector<Eigen::Vector3f>* samples) const {
  std::erase_if(*samples, [this](const Eigen::Vector3f& sample) {
    return (region && !region->Contains(sample)) ||
           (mask && !mask->Contains(sample));
  });
}

void Observability::RestrictTruth(std::vector<Eigen::Vector3f>* samples) const {
  std::erase_if(*samples, [this](const Eigen::Vector3f& sample) {
    return (region && !region->Contains(sample)) ||
           (ground_plane &&
            !(ground_plane->head<3>().dot(sample.cast<double>()) +
                  (*ground_plane)[3] >
              0));
  });
}

void Observability::RestrictDepths(const View& view, DepthMap* depths) const {
  if (!region) {
    return;
  }
  const Eigen::Vector3d center = view.Center();
  for (int row = 0; row < depths->height; ++row) {
    for (int col = 0; col < depths->width; ++col) {
      float& depth = depths->depths[depths->Index(row, col)];
      const Eigen::Vector3f ray = RayDirection(view, depths->Pixel(col) + 0.5,
                                               depths->Pixel(row) + 0.5);
      if (!region->Contains(
              Eigen::Vector3d(center + depth * ray.cast<double>()))) {
        depth = 0;
      }
    }
  }
}

double SurfaceDistances::AverageScore() const {
  return (accuracy.mean + accuracy.median + completeness.mean +
          completeness.median) /
         4;
}

MeshEvaluation EvaluateMesh(const MeshEvaluationOptions& options,
                            const TriangleMesh& mesh, const Truth& truth,
                            const std::vector<View>& views,
                            const Observability& observability,
                            const Progress& progress) {
  if (truth.depth_maps && views.empty()) {
    throw std::invalid_argument("depth maps need the views they belong to");
  }
  return Evaluator(options, mesh, truth, views, observability, progress)
      .Evaluate(mesh);
}

std::vector<double> VertexErrors(const TriangleMesh& mesh, const Truth& truth,
                                 double max_distance) {
  const Bvh tree(FinitePart(truth.surface, truth.IsPoints()));
  return Distances(mesh.vertices, tree, max_distance);
}

}  // namespace colmap_ext
