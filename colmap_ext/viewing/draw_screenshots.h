#pragma once

#include <functional>
#include <string>

#include "colmap_ext/options/viewer_options.h"
#include "colmap_ext/viewing/viewer_workspace.h"
#include "scene/color_image.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// A requested picture.
struct Screenshot {
  std::filesystem::path path;
  View view;
};

// The cameras of the requested pictures, in their order.
// \throw OptionError if there is no such camera.
std::vector<Screenshot> PlanScreenshots(const ViewerOptions& options,
                                        const ShownScene& scene);

// Draws pictures by OpenGL without a display.
// \param write  gets each picture.
// \return OpenGL's name of the renderer.
// \throw GlError if there is no OpenGL 4.5, or it fails.
std::string DrawScreenshots(
    const ViewerOptions& options, const ShownScene& scene,
    const std::vector<Screenshot>& screenshots,
    const std::function<void(const std::filesystem::path&, const ColorImage&)>&
        write);

// The index of the view with the name.
// \throw OptionError if there is none.
size_t FindView(const std::vector<View>& views, const std::string& name);

}  // namespace colmap_ext
