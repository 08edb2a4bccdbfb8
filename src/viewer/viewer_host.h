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

// Callbacks of the viewer into the program that it is part of. All return at
// once; the SceneInbox delivers the loaded data.
struct ViewerHost {
  // \param index  of the view in the scene.
  std::function<void(size_t index, const View& view)> load_image;
  std::function<void(const std::vector<View>& views)> load_thumbnails;
  std::function<void(std::shared_ptr<const ShownMesh> mesh, uint32_t facet,
                     const View& first, const View& second)>
      match_facet;

  // \return the outcome, in one line.
  std::function<std::string(const ColorImage& picture)> save_picture;

  // Pauses or resumes the computation. Empty: there is none.
  std::function<void(bool is_paused)> pause;
};

}  // namespace colmap_ext
