// measure_photographs: compares meshes of one scene by its photographs, and
// prints a table in Markdown.
//
// Correlation: each image is compared to the three nearby ones whose rays to
// the middle of the scene have the smallest angles between 4 and 40 degrees.
// They are carried into it through the mesh, and windows of 7 x 7 pixels with
// texture compared by ZNCC, on the windows that all the meshes cover. A window
// is covered where both images see all of it.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "colmap_ext/colmap_compat.h"
#include "evaluation/mesh_evaluation.h"
#include "formats/errors.h"
#include "formats/read_ply.h"
#include "mesh/adjacency.h"
#include "mesh/topology.h"
#include "mesh/triangle_mesh.h"
#include "repair/guarded_mesh.h"
#include "scene/images.h"
#include "scene/view.h"
#include "spatial/bvh.h"
#include "spatial/self_intersections.h"
#include "workspace/read_pictures.h"
#include "workspace/sparse_model.h"
#include "workspace/workspace.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

constexpr int kRadius = 3;  // px, of a window
constexpr int kWindowPixels = (2 * kRadius + 1) * (2 * kRadius + 1);
constexpr int kWindowStep = 2;       // px, between windows
constexpr double kMinVariance = 16;  // of a window with texture, grey values^2
constexpr int kBins = 2000;          // of correlations, from 0 to 1
constexpr int kSlitWidth = 24;       // px; gaps that are wider are no slits

using FloatImage = std::vector<float>;  // [height * width]; NaN: not seen

struct Photograph {
  View view;
  GrayImage image;

  float GrayAt(int row, int col) const { return image.At(row, col); }
};

struct ComparedMesh {
  std::string name;
  TriangleMesh mesh;
  std::unique_ptr<Bvh> bvh;

  // Of all images.
  double correlation_sum = 0;
  size_t num_correlated = 0;
  size_t num_over = 0;  // whose correlation is above 0.9
  std::vector<size_t> histogram = std::vector<size_t>(kBins + 1);
  size_t num_covered = 0;
  size_t num_slit_pixels = 0;
  size_t num_mesh_pixels = 0;

  void AddCorrelation(double correlation) {
    correlation_sum += correlation;
    ++num_correlated;
    num_over += correlation > 0.9 ? 1 : 0;
    ++histogram[std::lround(kBins * std::clamp(correlation, 0.0, 1.0))];
  }

  double MedianCorrelation() const {
    size_t below = 0;
    for (int bin = 0; bin < kBins; ++bin) {
      below += histogram[bin];
      if (2 * below > num_correlated) {
        return 1.0 * bin / kBins;
      }
    }
    return 1;
  }
};

Eigen::Vector3f PointAt(const View& view, int row, int col, float depth) {
  return view.Center().cast<float>() +
         depth * RayDirection(view, col + 0.5, row + 0.5);
}

// Bilinear; NaN near the border and outside.
float SampleAt(const Photograph& photograph, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d at = pixel.array() - 0.5;
  if (!(at.x() >= 1 && at.y() >= 1 && at.x() <= photograph.image.width - 3 &&
        at.y() <= photograph.image.height - 3)) {
    return std::numeric_limits<float>::quiet_NaN();
  }
  const int col = static_cast<int>(at.x());
  const int row = static_cast<int>(at.y());
  const auto x = static_cast<float>(at.x() - col);
  const auto y = static_cast<float>(at.y() - row);
  const auto blend = [&](int r) {
    return photograph.GrayAt(r, col) * (1 - x) +
           photograph.GrayAt(r, col + 1) * x;
  };
  return blend(row) * (1 - y) + blend(row + 1) * y;
}

// What `other` shows of the surface that `view` sees in each of its pixels; NaN
// where it does not see it.
FloatImage CarryOver(const View& view, const DepthMap& depths,
                     const Photograph& other, const Bvh& bvh) {
  // Of the way from the camera to the surface: what is nearer hides it.
  constexpr float kUntil = 1 - 2e-3f;
  FloatImage carried(depths.depths.size(),
                     std::numeric_limits<float>::quiet_NaN());
  tbb::parallel_for(0, view.height, [&](int row) {
    RayPacket rays;
    rays.origin = other.view.Center().cast<float>();
    rays.max_distance = kUntil;
    for (int first = 0; first < view.width; first += 4) {
      std::array<float, 4> values;
      values.fill(std::numeric_limits<float>::quiet_NaN());
      for (int i = 0; i < 4; ++i) {
        rays.SetDirection(i, Eigen::Vector3f::UnitX());
        const int col = first + i;
        if (col >= view.width) {
          continue;
        }
        const float depth = depths.depths[depths.Index(row, col)];
        if (depth == 0) {
          continue;
        }
        const Eigen::Vector3f point = PointAt(view, row, col, depth);
        const Eigen::Vector3d in_camera =
            other.view.CamFromWorld(point.cast<double>());
        if (in_camera.z() > 0) {
          values[i] = SampleAt(other, other.view.ImageFromCam(in_camera));
          rays.SetDirection(i, point - rays.origin);
        }
      }
      const HitPacket hit = bvh.Intersect(rays);
      for (int i = 0; i < 4 && first + i < view.width; ++i) {
        if (hit.facet[i] < 0) {
          carried[depths.Index(row, first + i)] = values[i];
        }
      }
    }
  });
  return carried;
}

// The ZNCC of a window around a pixel; NaN where it is not seen whole.
double Correlate(const Photograph& photograph, const FloatImage& carried,
                 int row, int col) {
  double a = 0;
  double b = 0;
  double aa = 0;
  double bb = 0;
  double ab = 0;
  for (int r = row - kRadius; r <= row + kRadius; ++r) {
    for (int c = col - kRadius; c <= col + kRadius; ++c) {
      const double x = photograph.GrayAt(r, c);
      const double y =
          carried[static_cast<size_t>(r) * photograph.image.width + c];
      a += x;
      b += y;
      aa += x * x;
      bb += y * y;
      ab += x * y;
    }
  }
  if (std::isnan(b)) {
    return b;
  }
  const double variances =
      (aa - a * a / kWindowPixels) * (bb - b * b / kWindowPixels);
  return variances > 1e-3 ? (ab - a * b / kWindowPixels) / std::sqrt(variances)
                          : 0;
}

bool HasTexture(const Photograph& photograph, int row, int col) {
  double sum = 0;
  double squares = 0;
  for (int r = row - kRadius; r <= row + kRadius; ++r) {
    for (int c = col - kRadius; c <= col + kRadius; ++c) {
      const double x = photograph.GrayAt(r, c);
      sum += x;
      squares += x * x;
    }
  }
  return squares - sum * sum / kWindowPixels >= kMinVariance * kWindowPixels;
}

// Adds the windows of an image compared to another one.
// \param carried [meshes] see CarryOver()
// \return how many have texture
size_t CompareWindows(const Photograph& photograph,
                      const std::vector<FloatImage>& carried,
                      std::vector<ComparedMesh>* meshes) {
  const int num_rows =
      (photograph.image.height - 2 * kRadius + kWindowStep - 1) / kWindowStep;
  size_t num_windows = 0;
  std::mutex mutex;
  tbb::parallel_for(0, num_rows, [&](int i) {
    const int row = kRadius + i * kWindowStep;
    std::vector<std::vector<double>> correlations;
    for (int col = kRadius; col < photograph.image.width - kRadius;
         col += kWindowStep) {
      if (HasTexture(photograph, row, col)) {
        auto& window = correlations.emplace_back();
        for (const FloatImage& image : carried) {
          window.push_back(Correlate(photograph, image, row, col));
        }
      }
    }
    const std::lock_guard lock(mutex);
    num_windows += correlations.size();
    for (const std::vector<double>& window : correlations) {
      const bool is_shared = std::none_of(
          window.begin(), window.end(), [](double x) { return std::isnan(x); });
      for (size_t m = 0; m < meshes->size(); ++m) {
        (*meshes)[m].num_covered += std::isnan(window[m]) ? 0 : 1;
        if (is_shared) {
          (*meshes)[m].AddCorrelation(window[m]);
        }
      }
    }
  });
  return num_windows;
}

// Which background pixels lie between two pixels of the mesh that are close to
// each other, along lines of pixels.
// \param start, step  a line's pixels are start + i * step, 0 <= i < length
void MarkSlits(const std::vector<float>& depths, size_t start, size_t step,
               int length, std::vector<uint8_t>* is_slit) {
  int last = -1;
  for (int i = 0; i < length; ++i) {
    if (depths[start + i * step] == 0) {
      continue;
    }
    if (last >= 0 && i - last - 1 < kSlitWidth) {
      for (int k = last + 1; k < i; ++k) {
        (*is_slit)[start + k * step] = 1;
      }
    }
    last = i;
  }
}

void CountSlits(const DepthMap& map, ComparedMesh* mesh) {
  const std::vector<float>& depths = map.depths;
  std::vector<uint8_t> is_slit(depths.size());
  for (int row = 0; row < map.height; ++row) {
    MarkSlits(depths, map.Index(row, 0), 1, map.width, &is_slit);
  }
  for (int col = 0; col < map.width; ++col) {
    MarkSlits(depths, col, map.width, map.height, &is_slit);
  }
  mesh->num_slit_pixels += std::count(is_slit.begin(), is_slit.end(), 1);
  mesh->num_mesh_pixels += std::count_if(depths.begin(), depths.end(),
                                         [](float x) { return x != 0; });
}

// The images that an image is compared to, by the surface that it sees.
std::vector<size_t> FindPartners(const std::vector<Photograph>& photographs,
                                 size_t index,
                                 const std::vector<float>& depths) {
  constexpr size_t kMaxPartners = 3;
  double sum = 0;
  size_t num_seen = 0;
  for (const float depth : depths) {
    sum += depth;
    num_seen += depth == 0 ? 0 : 1;
  }
  if (num_seen == 0) {
    return {};
  }
  const View& view = photographs[index].view;
  const Eigen::Vector3d axis =
      view.cam_from_world_rotation.row(2).transpose().normalized();
  const Eigen::Vector3d target =
      view.Center() + axis * (sum / static_cast<double>(num_seen));
  std::vector<std::pair<double, size_t>> partners;
  for (size_t i = 0; i < photographs.size(); ++i) {
    const Eigen::Vector3d a = target - view.Center();
    const Eigen::Vector3d b = target - photographs[i].view.Center();
    const double angle =
        std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / EIGEN_PI;
    if (i != index && angle > 4 && angle < 40) {
      partners.emplace_back(angle, i);
    }
  }
  std::sort(partners.begin(), partners.end());
  partners.resize(std::min(partners.size(), kMaxPartners));
  std::vector<size_t> indices;
  for (const auto& [angle, i] : partners) {
    indices.push_back(i);
  }
  return indices;
}

// \return how many windows have texture
size_t Compare(const std::vector<Photograph>& photographs,
               std::vector<ComparedMesh>* meshes) {
  size_t num_windows = 0;
  for (size_t i = 0; i < photographs.size(); ++i) {
    const Photograph& photograph = photographs[i];
    std::vector<DepthMap> depths;
    for (ComparedMesh& mesh : *meshes) {
      depths.push_back(RenderDepths(*mesh.bvh, photograph.view, 1));
      CountSlits(depths.back(), &mesh);
    }
    for (const size_t k : FindPartners(photographs, i, depths[0].depths)) {
      std::vector<FloatImage> carried;
      for (size_t m = 0; m < meshes->size(); ++m) {
        carried.push_back(CarryOver(photograph.view, depths[m], photographs[k],
                                    *(*meshes)[m].bvh));
      }
      num_windows += CompareWindows(photograph, carried, meshes);
    }
  }
  return num_windows;
}

// The smallest angle of each facet, degrees, ascending.
std::vector<double> SmallestAngles(const TriangleMesh& mesh) {
  std::vector<double> angles;
  for (const Facet& facet : mesh.facets) {
    const auto corners = CornersOf<double>(mesh, facet);
    double smallest = 180;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d a = corners[(i + 1) % 3] - corners[i];
      const Eigen::Vector3d b = corners[(i + 2) % 3] - corners[i];
      smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
    }
    angles.push_back(smallest * 180 / EIGEN_PI);
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

size_t CountFoldedEdges(const TriangleMesh& mesh) {
  std::vector<uint32_t> facets(mesh.facets.size());
  std::iota(facets.begin(), facets.end(), 0);
  return FoldsOf(mesh, PairHalfEdges(mesh.facets), facets).size();
}

std::vector<Photograph> ReadPhotographs(const fs::path& workspace) {
  const PictureDecoder decoder = ColmapPictureDecoder();
  const Views views = ReadViews(
      workspace, ReadSparseModel(FindSparseFolder(workspace)), {}, decoder);
  const ReadGrayImage read =
      PictureReader(workspace / "images", views.views, decoder);
  std::vector<Photograph> photographs;
  for (size_t i = 0; i < views.views.size(); ++i) {
    photographs.push_back({views.views[i], read(i)});
  }
  return photographs;
}

void PrintTable(const std::string& title,
                const std::vector<ComparedMesh>& meshes, size_t num_windows) {
  std::cout << "\n### " << title << ": photographs\n\n"
            << "|  | correlation | covered | slits, 1e-6 | faces | angles | "
               "under 10 degrees | folded edges | intersections | singular "
               "vertices |\n"
            << "|---|---|---|---|---|---|---|---|---|---|\n"
            << std::fixed;
  for (const ComparedMesh& mesh : meshes) {
    const auto share = [](size_t part, size_t all) {
      return static_cast<double>(part) /
             static_cast<double>(std::max<size_t>(all, 1));
    };
    const std::vector<double> angles = SmallestAngles(mesh.mesh);
    const auto num_narrow = static_cast<size_t>(
        std::lower_bound(angles.begin(), angles.end(), 10.0) - angles.begin());
    std::cout << "| " << mesh.name << " | " << std::setprecision(4)
              << mesh.correlation_sum / static_cast<double>(std::max<size_t>(
                                            mesh.num_correlated, 1))
              << ", " << mesh.MedianCorrelation() << ", "
              << share(mesh.num_over, mesh.num_correlated) << " | "
              << std::setprecision(3) << share(mesh.num_covered, num_windows)
              << " | " << std::setprecision(0)
              << 1e6 * share(mesh.num_slit_pixels, mesh.num_mesh_pixels)
              << " | " << angles.size() << " | " << std::setprecision(1)
              << angles[angles.size() / 2] << ", "
              << angles[angles.size() / 100] << " | " << std::setprecision(3)
              << 100 * share(num_narrow, angles.size()) << " % | "
              << CountFoldedEdges(mesh.mesh) << " | "
              << FindSelfIntersections(mesh.mesh).size() << " | "
              << Analyze(mesh.mesh).num_singular_vertices << " |\n";
  }
}

// \param words  WORKSPACE NAME=MESH...
void Run(const std::vector<std::string>& words) {
  const fs::path workspace = words[0];
  std::vector<ComparedMesh> meshes;
  for (size_t i = 1; i < words.size(); ++i) {
    const size_t sign = words[i].find('=');
    if (sign == std::string::npos) {
      throw std::invalid_argument(words[i] + ": not NAME=MESH");
    }
    ComparedMesh& mesh = meshes.emplace_back();
    mesh.name = words[i].substr(0, sign);
    mesh.mesh = ReadPlyMesh(words[i].substr(sign + 1));
    if (mesh.mesh.facets.empty()) {
      throw FileError(words[i].substr(sign + 1), "it has no faces");
    }
    mesh.bvh = std::make_unique<Bvh>(mesh.mesh);
  }
  const size_t num_windows = Compare(ReadPhotographs(workspace), &meshes);
  PrintTable(fs::canonical(workspace).filename().string(), meshes, num_windows);
}

}  // namespace
}  // namespace colmap_ext

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 2) {
    std::cerr << "Usage: measure_photographs WORKSPACE NAME=MESH.ply...\n";
    return 1;
  }
  try {
    colmap_ext::Run(words);
  } catch (const std::exception& error) {
    std::cerr << "ERROR: " << error.what() << "\n";
    return 1;
  }
}
