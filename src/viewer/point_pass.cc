#include "viewer/point_pass.h"

#include <array>
#include <cstdint>
#include <vector>

namespace colmap_ext {

namespace {

using Rgba = std::array<uint8_t, 4>;

void AddAttribute(const GlVertexArray& array, GLuint index, GLint size,
                  GLenum type, GLboolean is_normalized) {
  glEnableVertexArrayAttrib(array.Name(), index);
  glVertexArrayAttribFormat(array.Name(), index, size, type, is_normalized, 0);
  glVertexArrayAttribBinding(array.Name(), index, index);
}

std::vector<Rgba> WithAlpha(size_t count, std::span<const Color> colors) {
  constexpr Rgba kGray = {150, 150, 146, 255};
  std::vector<Rgba> padded(count, kGray);
  for (size_t i = 0; i < colors.size(); ++i) {
    padded[i] = {colors[i][0], colors[i][1], colors[i][2], 255};
  }
  return padded;
}

}  // namespace

PointPass::PointPass()
    : program_({"viewer_points.vert", "viewer_points.frag"}) {
  AddAttribute(vertex_array_, 0, 3, GL_FLOAT, GL_FALSE);
  AddAttribute(vertex_array_, 1, 4, GL_UNSIGNED_BYTE, GL_TRUE);
}

void PointPass::Draw(const std::shared_ptr<const void>& owner,
                     std::span<const Eigen::Vector3f> positions,
                     std::span<const Color> colors,
                     const PictureProjection& projection, float diameter) {
  if (owner != owner_) {
    positions_.Resize(positions.size_bytes());
    positions_.Write(positions.data(), positions.size_bytes());
    colors_.Assign(WithAlpha(positions.size(), colors));
    owner_ = owner;
  }
  SetProjection(projection, &program_);
  SetEye(projection, &program_);
  program_.Set("diameter", diameter);
  program_.Use();
  glEnable(GL_PROGRAM_POINT_SIZE);
  glVertexArrayVertexBuffer(vertex_array_.Name(), 0, positions_.Name(), 0,
                            sizeof(Eigen::Vector3f));
  glVertexArrayVertexBuffer(vertex_array_.Name(), 1, colors_.Name(), 0,
                            sizeof(Rgba));
  glBindVertexArray(vertex_array_.Name());
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(positions.size()));
}

}  // namespace colmap_ext
