#include "evaluation/mesh_evaluation.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "base/percentile.h"
#include "scene/depth_maps.h"

namespace colmap_ext {
namespace {

using Points = std::vector<Eigen::Vector3f>;

// Fractions of the diagonal of the truth's bounding box, chosen by hand close
// to DTU's 20 mm and 0.2 mm.
constexpr double kMaxDistanceShare = 0.05;
constexpr double kSpacingShare = 0.001;

double Diagonal(const Points& points) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : points) {
    box.extend(point);
  }
  return box.isEmpty() ? 0 : box.diagonal().cast<double>().norm();
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

struct Evaluator {
  const MeshEvaluationOptions& options;
  const Truth& truth;
  const std::vector<View>& views;
  const Observability& observability;
  const Progress& progress;
  const TriangleMesh mesh;     // its finite part
  const TriangleMesh surface;  // the finite part of the truth
  MeshEvaluation evaluation{};
  Points mesh_samples{};
  Points truth_samples{};
  const Bvh mesh_tree{mesh};
  const Bvh truth_tree{surface};

  MeshEvaluation Run() {
    evaluation.num_views = views.size();
    if (!views.empty()) {
      CastViews();
    }
    if (!truth.depth_maps) {
      MeasureDistances();
    }
    return evaluation;
  }

  void CastViews() {
    DepthErrors errors;
    errors.thresholds = options.depth_thresholds;
    for (size_t i = 0; i < views.size(); ++i) {
      Report(progress, "Casting rays",
             static_cast<double>(i) / static_cast<double>(views.size()));
      CastView(i, &errors);
    }
    if (truth.IsPoints()) {
      truth_samples = PointsInImages(surface.vertices, views);
      return;
    }
    if (errors.num_depths == 0) {
      throw std::invalid_argument(
          "no image sees the truth: are mesh, truth and workspace in the same "
          "frame?");
    }
    evaluation.depths = errors;
  }

  void CastView(size_t index, DepthErrors* errors) {
    View view = views[index];
    DepthMap true_depths;
    if (truth.depth_maps) {
      const DepthMap map = truth.depth_maps(index);
      if (map.depths.empty()) {
        ++evaluation.num_views_without_depths;
        return;
      }
      view = ResizeView(view, map.width, map.height);
      true_depths = Subsample(map, options.stride);
    } else if (!truth.IsPoints()) {
      true_depths = RenderDepths(truth_tree, view, options.stride);
    }
    observability.RestrictDepths(view, &true_depths);
    const DepthMap depths = RenderDepths(mesh_tree, view, options.stride);
    if (truth.IsPoints()) {
      Append(PointsWhere(depths, depths, view), &mesh_samples);
      return;
    }
    AddDepthErrors(true_depths, depths, errors);
    if (!truth.depth_maps) {
      Append(PointsWhere(depths, true_depths, view), &mesh_samples);
      Append(PointsWhere(true_depths, true_depths, view), &truth_samples);
    }
  }

  void MeasureDistances() {
    const double diagonal =
        Diagonal(views.empty() ? surface.vertices : truth_samples);
    SurfaceDistances result;
    result.spacing =
        options.spacing > 0 ? options.spacing : kSpacingShare * diagonal;
    result.max_distance = options.max_distance > 0
                              ? options.max_distance
                              : kMaxDistanceShare * diagonal;
    if (!(result.spacing > 0 && result.max_distance > 0)) {
      throw std::invalid_argument(
          "the truth has no extent to take the spacing of the samples and the "
          "maximum distance from");
    }
    Report(progress, "Measuring distances", 0);
    if (views.empty()) {
      mesh_samples = SampleSurface(mesh, result.spacing);
      truth_samples = truth.IsPoints() ? surface.vertices
                                       : SampleSurface(surface, result.spacing);
    }
    observability.RestrictMesh(&mesh_samples);
    observability.RestrictTruth(&truth_samples);
    DownsampleByVoxels(result.spacing, &mesh_samples);
    DownsampleByVoxels(result.spacing, &truth_samples);
    const auto measure = [&](const Points& points, const Bvh& tree) {
      return Summarize(Distances(points, tree, result.max_distance),
                       result.max_distance, options.drop_beyond);
    };
    result.accuracy = measure(mesh_samples, truth_tree);
    result.completeness = measure(truth_samples, mesh_tree);
    evaluation.distances = result;
  }
};

}  // namespace

DistanceStatistics Summarize(std::vector<double> distances, double max_distance,
                             bool drop_beyond) {
  DistanceStatistics statistics;
  statistics.num_samples = distances.size();
  std::ranges::sort(distances);
  const auto beyond = std::ranges::lower_bound(distances, max_distance);
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
  Report(progress, "Building trees", 0);
  Evaluator evaluator{options,
                      truth,
                      views,
                      observability,
                      progress,
                      FinitePart(mesh, false),
                      FinitePart(truth.surface, truth.IsPoints())};
  MeshEvaluation evaluation = evaluator.Run();
  evaluation.topology = Analyze(mesh);
  evaluation.num_dropped_facets =
      mesh.facets.size() - evaluator.mesh.facets.size();
  return evaluation;
}

std::vector<double> VertexErrors(const TriangleMesh& mesh, const Truth& truth,
                                 double max_distance) {
  const Bvh tree(FinitePart(truth.surface, truth.IsPoints()));
  return Distances(mesh.vertices, tree, max_distance);
}

}  // namespace colmap_ext
