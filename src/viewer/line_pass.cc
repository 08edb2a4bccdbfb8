#include "viewer/line_pass.h"

namespace colmap_ext {

LinePass::LinePass() : program_({"viewer_lines.vert", "viewer_lines.frag"}) {}

void LinePass::Draw(const std::vector<Eigen::Vector3f>& ends,
                    const Eigen::Vector3f& color,
                    const PictureProjection& projection, float width) {
  constexpr size_t kVerticesOfLine = 6;  // as viewer_lines.vert
  ends_.Assign(ends);
  SetProjection(projection, &program_);
  SetEye(projection, &program_);
  program_.Set("line_width", width);
  program_.Set("line_color", color);
  program_.Use();
  ends_.BindToStorage(0);
  glBindVertexArray(vertex_array_.Name());
  glDrawArrays(GL_TRIANGLES, 0,
               static_cast<GLsizei>(ends.size() / 2 * kVerticesOfLine));
}

}  // namespace colmap_ext
