#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// Clips a facet, of which any part may lie behind the camera, to what a view
// shows in a box of its image's plane [Sutherland1974]. Each side of the box is
// a plane through the camera's centre. No near plane is needed: between two
// opposite sides z is positive, but for the centre itself.
//
// An edge is cut at the same point in both of its facets.
//
// \param box  px; it may be larger than the image.
// \return the corners of a convex polygon in the camera's frame, all before the
//         camera; empty if the view shows no part of the facet in the box, or
//         the camera's centre lies on the facet.
std::vector<Eigen::Vector3d> ClipToImage(const View& view,
                                         const TriangleMesh& mesh,
                                         const Facet& facet,
                                         const Eigen::AlignedBox2d& box);

// The image less a border, px; more than the image where it is negative.
Eigen::AlignedBox2d ImageBox(const View& view, double border = 0);

// Returns the area that a facet covers in a view's image, px^2, wherever it
// ends and whatever occludes it. Of a facet that reaches behind the camera
// the part within the image counts.
double AreaInImage(const TriangleMesh& mesh, const Facet& facet,
                   const View& view);

// What a pixel covers at a point in the nearest of the views that see it: depth
// over the larger focal length, scene units. Infinite where none sees it.
// \param view_indices  < views.size()
double NearestFootprint(const Eigen::Vector3f& point,
                        std::span<const uint32_t> view_indices,
                        const std::vector<View>& views);

// What a pixel covers at each vertex: [V] scene units, the median over the
// views that see it, and MedianFootprint() where none does.
// \param vertex_views [V] see VertexAttributes
std::vector<float> Footprints(const TriangleMesh& mesh,
                              const Rows<uint32_t>& vertex_views,
                              const std::vector<View>& views);

// What a pixel covers on a mesh, the median over its vertices and the views
// that see them: depth over focal length, scene units. 0 where no view sees a
// vertex.
// \param vertex_views [V] see VertexAttributes
double MedianFootprint(const TriangleMesh& mesh,
                       const Rows<uint32_t>& vertex_views,
                       const std::vector<View>& views);

// Whether the cosine between a facet's normal and the ray from its centroid to
// the camera's centre is above min_cosine.
bool IsFacing(const TriangleMesh& mesh, const Facet& facet,
              const Eigen::Vector3d& camera, double min_cosine);

// A facet's plane and the barycentric coordinates on it, in the world frame.
struct FacetFrame {
  Eigen::Vector3d normal;      // towards free space, unit; 0: degenerate
  Eigen::Vector3d corner;      // the first, scene units
  Eigen::Vector3d gradient_1;  // of the second corner's barycentric coordinate,
                               // 1 / scene unit
  Eigen::Vector3d gradient_2;  // of the third's
};

inline FacetFrame ComputeFacetFrame(const TriangleMesh& mesh,
                                    const Facet& facet) {
  const auto [a, b, c] = CornersOf<double>(mesh, facet);
  const Eigen::Vector3d edge_1 = b - a;
  const Eigen::Vector3d edge_2 = c - a;
  const Eigen::Vector3d cross = edge_1.cross(edge_2);
  const double area = cross.norm();  // twice
  if (!(area > 0)) {
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    return {zero, a, zero, zero};
  }
  const Eigen::Vector3d normal = cross / area;
  return {normal, a, edge_2.cross(normal) / area, normal.cross(edge_1) / area};
}

// The inverse depth of a facet's plane in a view: it is linear over the image.
// \return of (u, v, 1), px -> 1 / scene unit; not finite where the camera's
//         centre lies on the plane
Eigen::Vector3d InverseDepthByPixel(const View& view, const TriangleMesh& mesh,
                                    const Facet& facet);

// By how much the inverse depth of a facet's plane changes in a view, at most,
// from a pixel to one of the eight around it, 1 / scene unit.
double PlaneSlope(const View& view, const TriangleMesh& mesh,
                  const Facet& facet);

}  // namespace colmap_ext
