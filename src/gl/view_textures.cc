#include "gl/view_textures.h"

#include <utility>

#include "scene/gray_image.h"

namespace colmap_ext {

ViewTextures::ViewTextures(const GrayImage& gray_image, int width, int height)
    : image(GL_R8UI, width, height), drawn(width, height) {
  image.Write(GL_RED_INTEGER, GL_UNSIGNED_BYTE, gray_image.pixels.data());
}

size_t ViewTextures::Memory(const View& view, size_t num_facets) {
  constexpr size_t kBytesPerPixel = 9;  // Grey value, facet, depth.
  return kBytesPerPixel * view.width * view.height + num_facets / 8;
}

ViewTextureCache::ViewTextureCache(std::shared_ptr<ImagePyramid> images,
                                   double min_cosine, size_t max_memory)
    : images_(std::move(images)), drawer_(min_cosine), views_(max_memory) {}

void ViewTextureCache::SetMesh(std::shared_ptr<const TriangleMesh> mesh) {
  mesh_ = std::move(mesh);
  ++num_meshes_;
  vertices_.Assign(mesh_->vertices);
  facets_.Assign(mesh_->facets);
}

std::shared_ptr<const ViewTextures> ViewTextureCache::Get(size_t view) {
  const View& size = images_->Views()[view];
  const std::shared_ptr<ViewTextures> textures =
      views_.Get(view, ViewTextures::Memory(size, mesh_->facets.size()), [&] {
        return std::make_shared<ViewTextures>(*images_->Image(view), size.width,
                                              size.height);
      });
  if (textures->drawn_mesh != num_meshes_) {
    drawer_.Draw(size, *mesh_, vertices_, facets_, &textures->drawn,
                 images_->Mask(view).get());
    textures->drawn_mesh = num_meshes_;
  }
  return textures;
}

}  // namespace colmap_ext
