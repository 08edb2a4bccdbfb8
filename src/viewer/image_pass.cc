#include "viewer/image_pass.h"

#include <vector>

#include <Eigen/Core>

#include "viewer/camera_frusta.h"

namespace colmap_ext {

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

const GlTexture& ImagePass::Upload(
    const std::shared_ptr<const ColorImage>& image) {
  std::erase_if(uploaded_,
                [](const auto& entry) { return entry.second.image.expired(); });
  const auto found = uploaded_.find(image.get());
  if (found != uploaded_.end()) {
    return found->second.texture;
  }
  return uploaded_.emplace(image.get(), Uploaded{image, ImageTexture(*image)})
      .first->second.texture;
}

void ImagePass::Draw(const std::shared_ptr<const ColorImage>& image,
                     const View& view, double depth, double opacity,
                     const PictureProjection& projection) {
  const Eigen::Vector3d eye = projection.view.Center();
  std::vector<Eigen::Vector3f> corners;
  for (const Eigen::Vector3d& corner : ImageCorners(view, depth)) {
    corners.emplace_back((corner - eye).cast<float>());
  }
  corners_.Assign(corners);
  Upload(image).BindToSampler(0);
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

}  // namespace colmap_ext
