#include "gl/view_textures.h"

#include <algorithm>
#include <utility>

#include "scene/gray_image.h"

namespace colmap_ext {

namespace {

size_t Memory(const View& view) {
  constexpr size_t kBytesPerPixel = 9;  // Grey value, facet, depth.
  return kBytesPerPixel * view.width * view.height;
}

}  // namespace

ViewTextures::ViewTextures(const GrayImage& gray_image, int width, int height)
    : image(GL_R8UI, width, height), drawn(width, height) {
  image.Write(GL_RED_INTEGER, GL_UNSIGNED_BYTE, gray_image.pixels.data());
}

ViewTextureCache::ViewTextureCache(std::shared_ptr<ImagePyramid> images,
                                   double min_cosine, size_t max_memory)
    : images_(std::move(images)),
      max_memory_(max_memory),
      drawer_(min_cosine) {}

void ViewTextureCache::Clear() {
  entries_.clear();
  memory_ = 0;
}

void ViewTextureCache::SetMesh(const TriangleMesh& mesh) {
  mesh_ = mesh;
  vertices_.Assign(mesh.vertices);
  facets_.Assign(mesh.facets);
  for (Entry& entry : entries_) {
    entry.textures.is_drawn = false;
  }
}

void ViewTextureCache::MakeRoom(size_t num_bytes) {
  while (entries_.size() > 1 && memory_ + num_bytes > max_memory_) {
    memory_ -= entries_.back().memory;
    entries_.pop_back();
  }
}

const ViewTextures& ViewTextureCache::Get(size_t view) {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(),
                   [view](const Entry& entry) { return entry.view == view; });
  const View& size = images_->Views()[view];
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
  } else {
    const size_t memory = Memory(size);
    const std::shared_ptr<const GrayImage> image = images_->Image(view);
    MakeRoom(memory);
    entries_.emplace_front(view, memory, *image, size.width, size.height);
    memory_ += memory;
  }
  ViewTextures& textures = entries_.front().textures;
  if (!textures.is_drawn) {
    drawer_.Draw(size, mesh_, vertices_, facets_, &textures.drawn);
    textures.is_drawn = true;
  }
  return textures;
}

}  // namespace colmap_ext
