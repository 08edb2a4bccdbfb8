#pragma once

#include <vector>

#include <Eigen/Core>

#include "gl/gl_objects.h"
#include "gl/program.h"
#include "viewer/picture_projection.h"

namespace colmap_ext {

// Draws lines of a width in pixels.
class LinePass {
 public:
  LinePass();

  // \param ends  [2 L] world frame, scene units
  // \param color  red, green, blue, 0 ... 1
  // \param width  px
  void Draw(const std::vector<Eigen::Vector3f>& ends,
            const Eigen::Vector3f& color, const PictureProjection& projection,
            float width);

 private:
  Program program_;
  GlVertexArray vertex_array_;
  GlBuffer ends_;  // [2 L][3] float
};

}  // namespace colmap_ext
