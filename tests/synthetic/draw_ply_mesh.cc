#include "tests/synthetic/draw_ply_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "base/union_find.h"
#include "pictures/mesh_renderer.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Vector3f;

const Vector3f kPlain(0.78f, 0.78f, 0.76f);
const Vector3f kLines(0.1f, 0.15f, 0.3f);

// For each facet the lowest vertex of those it is connected with.
std::vector<int32_t> Components(const TriangleMesh& mesh) {
  UnionFind components(mesh.vertices.size());
  for (const Facet& facet : mesh.facets) {
    components.Join(facet[0], facet[1]);
    components.Join(facet[0], facet[2]);
  }
  std::vector<int32_t> labels;
  for (const Facet& facet : mesh.facets) {
    labels.push_back(static_cast<int32_t>(components.Find(facet[0])));
  }
  return labels;
}

// Whether a hit lies on a side of its facet.
bool IsOnLine(const TriangleMesh& mesh, const View& view, const FrontHit& hit) {
  constexpr float kWidth = 0.8f;  // px
  const Facet& facet = mesh.facets[hit.facet];
  float height = std::numeric_limits<float>::infinity();  // above a side
  for (int k = 0; k < 3; ++k) {
    const Vector3f side =
        mesh.vertices[facet[(k + 2) % 3]] - mesh.vertices[facet[(k + 1) % 3]];
    height = std::min(height, hit.areas[k] / side.norm());
  }
  const float pixel = hit.depth / static_cast<float>(view.fx);
  return height < 0.5f * kWidth * pixel;
}

// The pixels whose centres are within a disc, and nearer than what is there.
void DrawDisc(const Eigen::Vector2d& center, double radius, double depth,
              const Color& color, std::vector<double>* depths,
              ColorImage* image) {
  const auto first = [radius](double middle) {
    return static_cast<int>(std::max(0.0, std::ceil(middle - radius - 0.5)));
  };
  const auto end = [radius](double middle, int size) {
    return static_cast<int>(
        std::min(1.0 * size, std::floor(middle + radius - 0.5) + 1));
  };
  for (int row = first(center.y()); row < end(center.y(), image->height);
       ++row) {
    for (int col = first(center.x()); col < end(center.x(), image->width);
         ++col) {
      const size_t index = static_cast<size_t>(row) * image->width + col;
      if (std::hypot(col + 0.5 - center.x(), row + 0.5 - center.y()) <=
              radius &&
          depth < (*depths)[index]) {
        (*depths)[index] = depth;
        image->pixels[index] = color;
      }
    }
  }
}

ColorImage DrawPoints(const PlyMesh& ply, const View& view, double radius) {
  constexpr Color kBackground = {255, 255, 255};
  constexpr Color kGray = {199, 199, 194};
  constexpr double kMaxPixel = 1e6;  // farther off the picture is left out
  ColorImage image;
  image.width = view.width;
  image.height = view.height;
  image.pixels.resize(static_cast<size_t>(view.width) * view.height,
                      kBackground);
  std::vector<double> depths(image.pixels.size(),
                             std::numeric_limits<double>::infinity());
  for (size_t p = 0; p < ply.mesh.vertices.size(); ++p) {
    const Eigen::Vector3d in_camera =
        view.CamFromWorld(ply.mesh.vertices[p].cast<double>());
    if (!(in_camera.z() > 0)) {
      continue;
    }
    const Eigen::Vector2d center = view.ImageFromCam(in_camera);
    if (center.cwiseAbs().maxCoeff() < kMaxPixel) {
      DrawDisc(center, radius, in_camera.z(),
               ply.colors.empty() ? kGray : ply.colors[p], &depths, &image);
    }
  }
  return image;
}

}  // namespace

ColorImage DrawPlyMesh(const PlyMesh& ply, const View& view, DrawMode mode,
                       double point_radius) {
  const TriangleMesh& mesh = ply.mesh;
  if (mesh.facets.empty()) {
    return DrawPoints(ply, view, point_radius);
  }
  if (mode == DrawMode::kColor && !ply.colors.empty()) {
    return RenderVertexColors(mesh, ply.colors, view);
  }
  if (mode == DrawMode::kLabels) {
    return RenderLabels(
        mesh, ply.labels.empty() ? Components(mesh) : ply.labels, view);
  }
  return RenderMesh(mesh, view, [&](const FrontHit& hit) -> Vector3f {
    if (mode == DrawMode::kNormals) {
      return 0.5f * (hit.normal + Vector3f::Ones());
    }
    return mode == DrawMode::kWireframe && IsOnLine(mesh, view, hit)
               ? kLines
               : Vector3f(kPlain * hit.light);
  });
}

}  // namespace colmap_ext::synthetic
