#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "gl/gl_objects.h"
#include "gl/program.h"
#include "scene/point_cloud.h"
#include "viewer/picture_projection.h"

namespace colmap_ext {

// Draws points as discs. They are uploaded when they are first drawn.
class PointPass {
 public:
  PointPass();

  // \param owner  of the points, which are the same as long as it is.
  // \param colors  [P] or empty: grey
  // \param diameter  of the discs, px
  void Draw(const std::shared_ptr<const void>& owner,
            std::span<const Eigen::Vector3f> positions,
            std::span<const Color> colors, const PictureProjection& projection,
            float diameter);

 private:
  Program program_;
  GlVertexArray vertex_array_;
  std::shared_ptr<const void> owner_;  // of what is uploaded
  GlBuffer positions_;                 // [P][3] float
  GlBuffer colors_;                    // [P][4] uchar
};

}  // namespace colmap_ext
