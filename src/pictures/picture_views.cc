#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "base/percentile.h"
#include "pictures/mesh_renderer.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;

constexpr double kFocalLength = 1.5;  // in widths of the picture
constexpr double kKeptPercent = 98;   // of the vertices are in it

// Sum of the facets' normals, weighted by area, or of the points'.
Vector3d SumOfNormals(const DrawnMesh& drawn) {
  const TriangleMesh& mesh = drawn.mesh;
  Vector3d sum = Vector3d::Zero();
  if (mesh.facets.empty()) {
    for (const Eigen::Vector3f& normal : drawn.normals) {
      sum += normal.cast<double>();
    }
  }
  for (const Facet& facet : mesh.facets) {
    const Eigen::Vector3f& a = mesh.vertices[facet[0]];
    sum += (mesh.vertices[facet[1]] - a)
               .cross(mesh.vertices[facet[2]] - a)
               .cast<double>();
  }
  return sum;
}

}  // namespace

View LookAtView(const Vector3d& eye, const Vector3d& target, const Vector3d& up,
                int width, int height) {
  View view;
  view.width = width;
  view.height = height;
  view.fx = view.fy = kFocalLength * width;
  view.cx = 0.5 * width;
  view.cy = 0.5 * height;
  const Vector3d forward = (target - eye).normalized();
  Vector3d right = forward.cross(up);
  if (right.norm() < 1e-9) {
    right = forward.unitOrthogonal();
  }
  right.normalize();
  view.cam_from_world_rotation.row(0) = right;
  view.cam_from_world_rotation.row(1) = forward.cross(right);
  view.cam_from_world_rotation.row(2) = forward;
  view.cam_from_world_translation = -view.cam_from_world_rotation * eye;
  return view;
}

View AutomaticView(const DrawnMesh& drawn, int width, int height) {
  const TriangleMesh& mesh = drawn.mesh;
  std::vector<double> coordinates[3];
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    for (int i = 0; i < 3; ++i) {
      coordinates[i].push_back(vertex[i]);
    }
  }
  if (mesh.vertices.empty()) {
    return LookAtView({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, width, height);
  }
  const Vector3d center(Median(&coordinates[0]), Median(&coordinates[1]),
                        Median(&coordinates[2]));
  std::vector<double> distances;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    distances.push_back((vertex.cast<double>() - center).norm());
  }
  const double radius = Percentile(kKeptPercent, &distances);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    const Vector3d d = vertex.cast<double>() - center;
    if (d.norm() <= radius) {
      covariance += d * d.transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Vector3d broad_side = solver.eigenvectors().col(0);
  if (broad_side.dot(SumOfNormals(drawn)) < 0) {
    broad_side = -broad_side;
  }
  const Vector3d up = solver.eigenvectors().col(1);
  const Vector3d across = solver.eigenvectors().col(2);
  const Vector3d direction =
      (broad_side - 0.6 * up + 0.25 * across).normalized();
  const double distance =
      1.1 * radius * 2 * kFocalLength * width / std::min(width, height);
  return LookAtView(center + distance * direction, center, broad_side, width,
                    height);
}

View CropView(const View& view, double zoom, double u, double v, int width,
              int height) {
  const double scale =
      zoom * std::min(static_cast<double>(width) / view.width,
                      static_cast<double>(height) / view.height);
  View crop = view;
  crop.width = width;
  crop.height = height;
  crop.fx = view.fx * scale;
  crop.fy = view.fy * scale;
  crop.cx = (view.cx - u * view.width) * scale + 0.5 * width;
  crop.cy = (view.cy - v * view.height) * scale + 0.5 * height;
  return crop;
}

}  // namespace colmap_ext
