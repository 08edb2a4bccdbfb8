#include "viewer/scene_renderer.h"

#include <array>
#include <cstdint>

#include "pictures/pictures.h"
#include "viewer/orbit_camera.h"

namespace colmap_ext {
namespace {

// Sets the uniforms of viewer_projection.glsl.
void SetProjection(const PictureProjection& projection, Program* program) {
  const View& view = projection.view;
  program->Set("cam_from_world_rotation",
               Eigen::Matrix3f(view.cam_from_world_rotation.cast<float>()));
  program->Set("focal", Eigen::Vector2f(view.fx, view.fy));
  program->Set("principal", Eigen::Vector2f(view.cx, view.cy));
  program->Set("size", Eigen::Vector2f(view.width, view.height));
  program->Set("near", static_cast<float>(projection.near));
}

// Sets the position of the camera.
void SetEye(const PictureProjection& projection, Program* program) {
  const Eigen::Vector3d center = projection.view.Center();
  const Eigen::Vector3f eye = center.cast<float>();
  program->Set("eye", eye);
  program->Set("eye_rest",
               Eigen::Vector3f((center - eye.cast<double>()).cast<float>()));
}

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

// As in viewer_mesh.frag.
ShaderConstants ColorConstants() {
  return {{"kPlain", static_cast<int>(ColorsOf::kPlain)},
          {"kVertices", static_cast<int>(ColorsOf::kVertices)},
          {"kFacets", static_cast<int>(ColorsOf::kFacets)},
          {"kNormals", static_cast<int>(ColorsOf::kNormals)}};
}

}  // namespace

GlTexture ImageTexture(const ColorImage& image) {
  GlTexture texture(GL_RGBA8, image.width, image.height);
  texture.Write(GL_RGB, GL_UNSIGNED_BYTE, image.pixels.data());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) {
    glTextureParameteri(texture.Name(), filter, GL_LINEAR);
  }
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) {
    glTextureParameteri(texture.Name(), axis, GL_CLAMP_TO_EDGE);
  }
  return texture;
}

ImagePass::ImagePass() : program_({"viewer_image.vert", "viewer_image.frag"}) {}

void ImagePass::Draw(const std::shared_ptr<const ColorImage>& image,
                     const View& view, double depth, double opacity,
                     const PictureProjection& projection) {
  const Eigen::Vector3d eye = projection.view.Center();
  std::vector<Eigen::Vector3f> corners;
  for (const Eigen::Vector3d& corner : ImageCorners(view, depth)) {
    corners.emplace_back((corner - eye).cast<float>());
  }
  corners_.Assign(corners);
  textures_.Get(image, [&] { return ImageTexture(*image); }).BindToSampler(0);
  SetProjection(projection, &program_);
  program_.Set("opacity", static_cast<float>(opacity));
  program_.Use();
  corners_.BindToStorage(0);
  glColorMaski(1, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);  // the facets
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(vertex_array_.Name());
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  glDisable(GL_BLEND);
  glColorMaski(1, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

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

MeshPass::MeshPass()
    : program_({"viewer_mesh.vert", "viewer_mesh.frag"}, ColorConstants()) {
  AddAttribute(vertex_array_, 0, 3, GL_FLOAT, GL_FALSE);
}

void MeshPass::Draw(const std::shared_ptr<const ShownMesh>& mesh,
                    const DrawSettings& settings,
                    const PictureProjection& projection, float line_width) {
  Uploaded& uploaded = uploads_.Get(mesh, [&] {
    Uploaded made;
    made.vertices.Assign(mesh->mesh.vertices);
    made.facets.Assign(mesh->mesh.facets);
    return made;
  });
  const auto [place, is_new] = uploaded.colors.try_emplace(settings.mode);
  Uploaded::Colors& colors = place->second;
  if (is_new) {
    const MeshColors made = ColorsByMode(*mesh, settings.mode);
    colors.of = static_cast<int>(made.of);
    colors.shading = made.shading;
    colors.colors.Assign(made.colors);
  }
  SetProjection(projection, &program_);
  SetEye(projection, &program_);
  program_.Set("sun", SunDirection(projection.view));
  program_.Set("color_of", colors.of);
  program_.Set("shading", colors.shading);
  program_.Set("wireframe", settings.wireframe ? 1 : 0);
  program_.Set("backfaces", settings.backfaces ? 1 : 0);
  program_.Set("line_width", line_width);
  program_.Use();
  uploaded.vertices.BindToStorage(0);
  uploaded.facets.BindToStorage(1);
  colors.colors.BindToStorage(2);
  glVertexArrayVertexBuffer(vertex_array_.Name(), 0, uploaded.vertices.Name(),
                            0, sizeof(Eigen::Vector3f));
  glVertexArrayElementBuffer(vertex_array_.Name(), uploaded.facets.Name());
  glBindVertexArray(vertex_array_.Name());
  glDrawElements(GL_TRIANGLES,
                 static_cast<GLsizei>(3 * mesh->mesh.facets.size()),
                 GL_UNSIGNED_INT, nullptr);
}

}  // namespace colmap_ext
