#pragma once

#include <map>
#include <memory>

#include "gl/gl_objects.h"
#include "gl/program.h"
#include "scene/color_image.h"
#include "viewer/picture_projection.h"

namespace colmap_ext {

// A picture as a texture that is sampled between its pixels.
GlTexture ImageTexture(const ColorImage& image);

// Draws images on their planes before their cameras. Seen from its own camera
// an image fills exactly what it shows.
class ImagePass {
 public:
  ImagePass();

  // \param view  the camera of the image, which may have another size.
  // \param depth  of the plane, scene units
  // \param opacity  0 ... 1
  void Draw(const std::shared_ptr<const ColorImage>& image, const View& view,
            double depth, double opacity, const PictureProjection& projection);

 private:
  struct Uploaded {
    std::weak_ptr<const ColorImage> image;
    GlTexture texture;
  };

  const GlTexture& Upload(const std::shared_ptr<const ColorImage>& image);

  Program program_;
  GlVertexArray vertex_array_;
  GlBuffer corners_;  // [4][3] float, from the eye on, world frame
  std::map<const ColorImage*, Uploaded> uploaded_;
};

}  // namespace colmap_ext
