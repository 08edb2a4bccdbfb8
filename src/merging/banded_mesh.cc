#include "merging/banded_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/streamed_quantile.h"
#include "merging/band_numbers.h"
#include "merging/sectioned_repair.h"
#include "merging/sectioned_topology.h"
#include "mesh/clip_mesh.h"
#include "mesh/vertex_confidences.h"
#include "meshing/filter_surface.h"
#include "meshing/finish_surface.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {
namespace {

// A band, split and filtered.
struct FinishedBand {
  std::vector<FacetKey> keys;
  std::vector<uint8_t> is_own;
  FanSplit surface;  // its sources are the plan's vertices
  AttributedSurface attributed;

  bool IsOwn(size_t facet) const {
    return is_own[surface.facet_sources[facet]] != 0;
  }
};

class BandFinisher {
 public:
  BandFinisher(const ManifoldMeshingOptions& options, const SurfaceBands& bands,
               const ReadAttributes& read, const std::vector<View>& views,
               const MakeStore& make_store)
      : options_(options),
        bands_(bands),
        read_(read),
        views_(views),
        make_store_(make_store) {}

  // The first time through all bands.
  void FindLimits() {
    StoredVector<float> sides(make_store_);
    StreamedQuantile quantile;
    for (uint32_t tile = 0; tile < bands_.NumTiles(); ++tile) {
      const std::vector<float> of_tile = SidesOf(tile);
      for (const float side : of_tile) {
        quantile.Count(side, 1);
      }
      sides.Append(of_tile);
    }
    if (options_.max_side_length_factor <= 0 || sides.size() == 0) {
      limits_.longest_side = std::numeric_limits<double>::infinity();
      return;
    }
    // The rank of Percentile().
    const auto last = static_cast<double>(sides.size() - 1);
    quantile.Seek(1 +
                  std::round(options_.max_side_length_percentile / 100 * last));
    sides.ForEachChunk([&](const std::vector<float>& chunk) {
      for (const float side : chunk) {
        quantile.Keep(side, 1);
      }
    });
    limits_.longest_side = options_.max_side_length_factor * quantile.Find();
  }

  // The second time.
  void FindUsualDensity() {
    StoredVector<FacetDensity> densities(make_store_);
    StreamedQuantile quantile;
    ManifoldMeshingReport report;
    for (uint32_t tile = 0; tile < bands_.NumTiles(); ++tile) {
      const FinishedBand band = Finish(tile, &report);
      std::vector<FacetDensity> of_tile;
      for (size_t i = 0; i < band.attributed.densities.size(); ++i) {
        if (band.IsOwn(i)) {
          const FacetDensity& density = band.attributed.densities[i];
          quantile.Count(density.density, density.support);
          of_tile.push_back(density);
        }
      }
      densities.Append(of_tile);
    }
    if (densities.size() == 0) {
      throw std::invalid_argument(
          "the points and views enclose no surface: nothing to mesh");
    }
    quantile.Seek(quantile.Total() / 2);
    densities.ForEachChunk([&](const std::vector<FacetDensity>& chunk) {
      for (const FacetDensity& density : chunk) {
        quantile.Keep(density.density, density.support);
      }
    });
    usual_density_ = quantile.Find();
  }

  // The third.
  void Number(ManifoldMeshingReport* report, BandedMesh* result) {
    BandNumbers numbers;
    for (uint32_t tile = 0; tile < bands_.NumTiles(); ++tile) {
      const FinishedBand band = Finish(tile, report);
      Append(band, numbers.Add(band.surface, band.keys, band.is_own), result);
    }
    result->mesh.Finish();
  }

 private:
  VertexPoints PointsOf(const SurfaceBand& band) const {
    return colmap_ext::PointsOf(band.surface.ids, bands_.NumPlanVertices(),
                                read_);
  }

  // Of the tile's own facets.
  std::vector<float> SidesOf(uint32_t tile) {
    const SurfaceBand band = bands_.Read(tile);
    const FanSplit surface = SplitWithoutEnds(
        band.surface.extracted, PointsOf(band).is_end, band.is_own);
    limits_.largest_coordinate =
        std::max(limits_.largest_coordinate, LargestCoordinate(surface.mesh));
    const std::vector<float> sides = LongestSides(surface.mesh);
    std::vector<float> own;
    for (size_t i = 0; i < sides.size(); ++i) {
      if (band.is_own[surface.facet_sources[i]] != 0) {
        own.push_back(sides[i]);
      }
    }
    return own;
  }

  FinishedBand Finish(uint32_t tile, ManifoldMeshingReport* report) const {
    SurfaceBand band = bands_.Read(tile);
    const VertexPoints points = PointsOf(band);
    FinishedBand finished;
    finished.surface =
        SplitWithoutEnds(band.surface.extracted, points.is_end, band.is_own);
    band.surface.extracted = {};
    FilterSurface(options_, limits_, band.is_own, &finished.surface, report);
    finished.attributed =
        AddAttributes(finished.surface, points.AsSurfacePoints(), views_);
    for (auto& [a, b] : finished.surface.sources) {
      a = band.surface.ids[a];
      b = band.surface.ids[b];
    }
    finished.keys = std::move(band.keys);
    finished.is_own = std::move(band.is_own);
    return finished;
  }

  void Append(const FinishedBand& band, const NumberedBand& numbered,
              BandedMesh* result) const {
    const TriangleMesh& mesh = band.surface.mesh;
    const std::vector<float> confidences = VertexConfidences(
        mesh, ConfidencesOf(band.attributed.densities, usual_density_));
    const VertexAttributes& attributes = band.attributed.attributes;
    std::vector<Eigen::Vector3f> positions;
    std::vector<Color> colors;
    std::vector<float> new_confidences;
    std::vector<uint32_t> num_views;
    std::vector<uint32_t> views;
    for (const uint32_t vertex : numbered.new_vertices) {
      positions.push_back(mesh.vertices[vertex]);
      new_confidences.push_back(confidences[vertex]);
      if (!attributes.colors.empty()) {
        colors.push_back(attributes.colors[vertex]);
      }
      const auto row = attributes.views[vertex];
      num_views.push_back(static_cast<uint32_t>(row.size()));
      views.insert(views.end(), row.begin(), row.end());
    }
    std::vector<Eigen::AlignedBox3f> boxes;
    for (const uint32_t facet : numbered.own) {
      boxes.push_back(BoxOf(mesh, facet));
    }
    result->mesh.Add(positions, numbered.facets, numbered.shared, boxes);
    result->colors.Append(colors);
    result->confidences.Append(new_confidences);
    result->num_views.Append(num_views);
    result->views.Append(views);
  }

  const ManifoldMeshingOptions& options_;
  const SurfaceBands& bands_;
  const ReadAttributes& read_;
  const std::vector<View>& views_;
  const MakeStore& make_store_;
  SurfaceLimits limits_;
  double usual_density_ = 0;
};

}  // namespace

std::string NeedsWholeSurface(const ManifoldMeshingOptions& options) {
  if (options.borders.trim > 0) {
    return "trim";
  }
  if (options.borders.close_holes != 0) {
    return "close_holes";
  }
  if (options.remeshing) {
    return "remeshing";
  }
  return options.min_component_faces > 1 ? "min_component_faces" : "";
}

BandedMesh FinishBands(const ManifoldMeshingOptions& options,
                       const SurfaceBands& bands, const ReadAttributes& read,
                       const std::vector<View>& views, const Progress& progress,
                       const MakeStore& make_store,
                       ManifoldMeshingReport* report) {
  BandedMesh result(make_store);
  BandFinisher finisher(options, bands, read, views, make_store);
  finisher.FindLimits();
  Report(progress, "Weighing the surface", 0);
  finisher.FindUsualDensity();
  Report(progress, "Numbering the vertices", 0);
  finisher.Number(report, &result);
  Report(progress, "Repairing self-intersections", 0);
  report->self_intersections = RepairSections(&result.mesh);
  Report(progress, "Checking the mesh", 0);
  report->mesh = AnalyzeSections(result.mesh);
  if (!report->mesh.IsManifold()) {
    throw std::logic_error("the mesh is not manifold: " +
                           report->mesh.Defects());
  }
  return result;
}

}  // namespace colmap_ext
