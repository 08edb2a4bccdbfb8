#include "viewer/scene_renderer.h"

#include <array>

#include "gl/egl_context.h"
#include "viewer/orbit_camera.h"

namespace colmap_ext {
namespace {

// Distance from the camera to the first mesh or points, the scale of depths,
// scene units.
double Distance(const ShownScene& scene, const View& view) {
  const std::vector<Eigen::Vector3f>* points = nullptr;
  if (!scene.meshes.empty()) {
    points = &scene.meshes[0]->mesh.vertices;
  } else if (scene.points) {
    points = &scene.points->positions;
  }
  if (points == nullptr || points->empty() || !points->front().allFinite()) {
    return 1;
  }
  const double distance =
      (points->front().cast<double>() - view.Center()).norm();
  return distance > 0 ? distance : 1;
}

// Of points, drawn px.
float Diameter(const DrawSettings& settings) {
  return static_cast<float>(2 * settings.point_radius * settings.samples);
}

}  // namespace

SceneRenderer::Targets::Targets(int the_width, int the_height, int the_samples)
    : width(the_width),
      height(the_height),
      samples(the_samples),
      colors(GL_RGBA8, width * samples, height * samples),
      facets(GL_R32UI, width * samples, height * samples),
      depths(GL_DEPTH_COMPONENT32F, width * samples, height * samples),
      picture(GL_RGBA8, width, height) {
  drawn.Attach(GL_COLOR_ATTACHMENT0, colors);
  drawn.Attach(GL_COLOR_ATTACHMENT1, facets);
  drawn.Attach(GL_DEPTH_ATTACHMENT, depths);
  constexpr std::array<GLenum, 2> kBuffers = {GL_COLOR_ATTACHMENT0,
                                              GL_COLOR_ATTACHMENT1};
  glNamedFramebufferDrawBuffers(drawn.Name(), kBuffers.size(), kBuffers.data());
  shown.Attach(GL_COLOR_ATTACHMENT0, picture);
  if (glCheckNamedFramebufferStatus(drawn.Name(), GL_FRAMEBUFFER) !=
      GL_FRAMEBUFFER_COMPLETE) {
    throw GlError("This OpenGL cannot draw colors and numbers together");
  }
}

void SceneRenderer::Prepare(const View& view, const DrawSettings& settings) {
  if (!targets_ || targets_->width != view.width ||
      targets_->height != view.height ||
      targets_->samples != settings.samples) {
    targets_.reset();
    targets_.emplace(view.width, view.height, settings.samples);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, targets_->drawn.Name());
  glViewport(0, 0, view.width * settings.samples,
             view.height * settings.samples);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_DITHER);
  constexpr GLfloat kWhite[] = {1, 1, 1, 1};
  constexpr GLuint kNothing[] = {kNone, 0, 0, 0};
  constexpr GLfloat kFarAway = 0;
  glClearBufferfv(GL_COLOR, 0, kWhite);
  glClearBufferuiv(GL_COLOR, 1, kNothing);
  glClearBufferfv(GL_DEPTH, 0, &kFarAway);
}

void SceneRenderer::Draw(const ShownScene& scene, const View& view,
                         const DrawSettings& settings) {
  // Fraction of the distance; a small one costs no depth precision.
  constexpr double kNear = 1e-4;
  Prepare(view, settings);
  const int samples = settings.samples;
  const PictureProjection projection{
      ResizeView(view, view.width * samples, view.height * samples),
      kNear * Distance(scene, view)};
  if (settings.mesh < scene.meshes.size()) {
    DrawMesh(scene, settings, projection);
  }
  if (settings.points && scene.points) {
    point_pass_.Draw(scene.points, scene.points->positions,
                     scene.points->colors, projection, Diameter(settings));
  }
  if (settings.cameras) {
    DrawCameras(scene, projection);
  }
  if (settings.image) {
    DrawImage(scene, settings, projection);
  }
  if (settings.picked && settings.mesh < scene.meshes.size()) {
    DrawPicked(scene.meshes[settings.mesh]->mesh, *settings.picked, projection);
  }
  glBlitNamedFramebuffer(targets_->drawn.Name(), targets_->shown.Name(), 0, 0,
                         view.width * samples, view.height * samples, 0, 0,
                         view.width, view.height, GL_COLOR_BUFFER_BIT,
                         GL_LINEAR);
  glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  glDisable(GL_DEPTH_TEST);
  ThrowOnGlError("Drawing a picture");
}

void SceneRenderer::DrawMesh(const ShownScene& scene,
                             const DrawSettings& settings,
                             const PictureProjection& projection) {
  std::shared_ptr<const ShownMesh> mesh = scene.meshes[settings.mesh];
  const auto stand_in = scene.stand_ins.find(mesh.get());
  if (settings.stand_in && stand_in != scene.stand_ins.end()) {
    mesh = stand_in->second;
  }
  if (mesh->mesh.facets.empty()) {
    mesh_point_pass_.Draw(mesh, mesh->mesh.vertices, mesh->colors, projection,
                          Diameter(settings));
  } else {
    mesh_pass_.Draw(mesh, settings, projection,
                    static_cast<float>(settings.samples));
  }
}

void SceneRenderer::DrawCameras(const ShownScene& scene,
                                const PictureProjection& projection) {
  const Eigen::Vector3f kBlue(0.15F, 0.35F, 0.8F);
  constexpr float kWidth = 1.2F;  // px
  const double depth = FrustumDepth(scene.views);
  for (const auto& [view, thumbnail] : scene.thumbnails) {
    image_pass_.Draw(thumbnail, scene.views[view], depth, 1, projection);
  }
  const auto samples = static_cast<float>(targets_->samples);
  line_pass_.Draw(FrustumLines(scene.views, depth), kBlue, projection,
                  kWidth * samples);
}

void SceneRenderer::DrawPicked(const TriangleMesh& mesh, uint32_t facet,
                               const PictureProjection& projection) {
  const Eigen::Vector3f kOrange(0.95F, 0.5F, 0.05F);
  constexpr float kWidth = 2;  // px
  if (facet >= mesh.facets.size()) {
    return;
  }
  std::vector<Eigen::Vector3f> ends;
  for (int k = 0; k < 3; ++k) {
    ends.push_back(mesh.vertices[mesh.facets[facet][k]]);
    ends.push_back(mesh.vertices[mesh.facets[facet][(k + 1) % 3]]);
  }
  glDisable(GL_DEPTH_TEST);
  line_pass_.Draw(ends, kOrange, projection,
                  kWidth * static_cast<float>(targets_->samples));
}

void SceneRenderer::DrawImage(const ShownScene& scene,
                              const DrawSettings& settings,
                              const PictureProjection& projection) {
  const auto image = scene.images.find(*settings.image);
  if (image == scene.images.end()) {
    return;
  }
  glDisable(GL_DEPTH_TEST);
  image_pass_.Draw(image->second, scene.views[*settings.image],
                   FrustumDepth(scene.views), settings.image_opacity,
                   projection);
}

ColorImage SceneRenderer::Read() const {
  ColorImage image{targets_->width, targets_->height, {}};
  const auto pixels =
      targets_->picture.Read<std::array<uint8_t, 4>>(GL_RGBA, GL_UNSIGNED_BYTE);
  image.pixels.reserve(pixels.size());
  for (const auto& pixel : pixels) {
    image.pixels.push_back({pixel[0], pixel[1], pixel[2]});
  }
  return image;
}

uint32_t SceneRenderer::FacetAt(int row, int col) const {
  const int samples = targets_ ? targets_->samples : 0;
  if (samples == 0 || row < 0 || col < 0 || row >= targets_->height ||
      col >= targets_->width) {
    return kNone;
  }
  uint32_t facet = kNone;
  glGetTextureSubImage(targets_->facets.Name(), 0, col * samples + samples / 2,
                       row * samples + samples / 2, 0, 1, 1, 1, GL_RED_INTEGER,
                       GL_UNSIGNED_INT, sizeof(facet), &facet);
  return facet;
}

void SceneRenderer::ShowIn(GLuint framebuffer) const {
  // The window's first row is the lowest one.
  glBlitNamedFramebuffer(targets_->shown.Name(), framebuffer, 0, 0,
                         targets_->width, targets_->height, 0, targets_->height,
                         targets_->width, 0, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

}  // namespace colmap_ext
