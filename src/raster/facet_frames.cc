#include "raster/facet_frames.h"

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

namespace colmap_ext {

FacetFrame ComputeFacetFrame(const TriangleMesh& mesh, const Facet& facet) {
  FacetFrame frame;
  frame.corner = mesh.vertices[facet[0]].cast<double>();
  const Eigen::Vector3d edge_1 =
      mesh.vertices[facet[1]].cast<double>() - frame.corner;
  const Eigen::Vector3d edge_2 =
      mesh.vertices[facet[2]].cast<double>() - frame.corner;
  const Eigen::Vector3d cross = edge_1.cross(edge_2);
  const double area = cross.norm();  // twice
  if (!(area > 0)) {
    frame.normal.setZero();
    frame.gradient_1.setZero();
    frame.gradient_2.setZero();
    return frame;
  }
  frame.normal = cross / area;
  frame.gradient_1 = edge_2.cross(frame.normal) / area;
  frame.gradient_2 = frame.normal.cross(edge_1) / area;
  return frame;
}

std::vector<FacetFrame> ComputeFacetFrames(const TriangleMesh& mesh) {
  std::vector<FacetFrame> frames(mesh.facets.size());
  tbb::parallel_for(size_t{0}, frames.size(), [&](size_t i) {
    frames[i] = ComputeFacetFrame(mesh, mesh.facets[i]);
  });
  return frames;
}

}  // namespace colmap_ext
