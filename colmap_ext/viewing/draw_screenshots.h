#pragma once

#include <functional>
#include <string>

#include "colmap_ext/options/viewer_options.h"
#include "colmap_ext/viewing/viewer_workspace.h"
#include "scene/color_image.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// One of the pictures that are asked for.
struct Screenshot {
  std::filesystem::path path;
  View view;
};

// What is seen in the pictures, in their order.
// \throw OptionError if there is no such camera.
std::vector<Screenshot> PlanScreenshots(const ViewerOptions& options,
                                        const ShownScene& scene);

// Draws them by OpenGL without a display.
// \param write  gets each picture.
// \return what drew them, as OpenGL names it.
// \throw GlError if there is no OpenGL 4.5, or it fails.
std::string DrawScreenshots(
    const ViewerOptions& options, const ShownScene& scene,
    const std::vector<Screenshot>& screenshots,
    const std::function<void(const std::filesystem::path&, const ColorImage&)>&
        write);

// The view of that name.
// \throw OptionError if there is none.
size_t FindView(const std::vector<View>& views, const std::string& name);

}  // namespace colmap_ext
