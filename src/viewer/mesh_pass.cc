#include "viewer/mesh_pass.h"

#include <algorithm>

#include <Eigen/Core>

#include "viewer/mesh_colors.h"

namespace colmap_ext {

namespace {

// As in viewer_mesh.frag.
ShaderConstants ColorConstants() {
  return {{"kPlain", static_cast<int>(ColorsOf::kPlain)},
          {"kVertices", static_cast<int>(ColorsOf::kVertices)},
          {"kFacets", static_cast<int>(ColorsOf::kFacets)},
          {"kNormals", static_cast<int>(ColorsOf::kNormals)}};
}

// To the light: from above and to the left of the camera, world frame.
Eigen::Vector3f Sun(const View& view) {
  return (view.cam_from_world_rotation.transpose() *
          Eigen::Vector3d(-0.5, -0.6, -0.7).normalized())
      .cast<float>();
}

}  // namespace

MeshPass::MeshPass()
    : program_({"viewer_mesh.vert", "viewer_mesh.frag"}, ColorConstants()) {
  constexpr GLuint kPosition = 0;
  glEnableVertexArrayAttrib(vertex_array_.Name(), kPosition);
  glVertexArrayAttribFormat(vertex_array_.Name(), kPosition, 3, GL_FLOAT,
                            GL_FALSE, 0);
  glVertexArrayAttribBinding(vertex_array_.Name(), kPosition, 0);
}

MeshPass::Uploaded& MeshPass::Upload(
    const std::shared_ptr<const ShownMesh>& mesh) {
  const auto [place, is_new] = uploaded_.try_emplace(mesh.get());
  Uploaded& uploaded = place->second;
  if (is_new) {
    uploaded.mesh = mesh;
    uploaded.vertices.Assign(mesh->mesh.vertices);
    uploaded.facets.Assign(mesh->mesh.facets);
  }
  return uploaded;
}

void MeshPass::Draw(const std::shared_ptr<const ShownMesh>& mesh,
                    const DrawSettings& settings,
                    const PictureProjection& projection, float line_width) {
  Uploaded& uploaded = Upload(mesh);
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
  program_.Set("sun", Sun(projection.view));
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

void MeshPass::Forget(const ShownScene& scene) {
  std::erase_if(uploaded_, [&](const auto& entry) {
    const std::shared_ptr<const ShownMesh> uploaded = entry.second.mesh.lock();
    return std::ranges::none_of(
               scene.meshes,
               [&](const auto& mesh) { return mesh == uploaded; }) &&
           std::ranges::none_of(scene.stand_ins, [&](const auto& stand_in) {
             return stand_in.second == uploaded;
           });
  });
}

}  // namespace colmap_ext
