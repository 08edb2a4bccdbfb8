#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "scene/color_image.h"
#include "scene/view.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// What the viewer asks of the program that it is part of. All return at once;
// what they load comes by the SceneInbox.
struct ViewerHost {
  // \param index  of the view in the scene.
  std::function<void(size_t index, const View& view)> load_image;
  std::function<void(const std::vector<View>& views)> load_thumbnails;
  std::function<void(std::shared_ptr<const ShownMesh> mesh, uint32_t facet,
                     const View& first, const View& second)>
      match_facet;

  // \return what became of it, in one line.
  std::function<std::string(const ColorImage& picture)> save_picture;

  // Holds what is being computed, or lets it go on. Empty: there is nothing.
  std::function<void(bool is_paused)> pause;
};

}  // namespace colmap_ext
