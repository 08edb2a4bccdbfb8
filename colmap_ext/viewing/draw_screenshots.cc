#include "colmap_ext/viewing/draw_screenshots.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "colmap_ext/errors.h"
#include "gl/egl_context.h"
#include "pictures/picture_views.h"
#include "viewer/orbit_camera.h"
#include "viewer/scene_renderer.h"

namespace colmap_ext {

namespace {

// The requested part of a view.
View Crop(const ViewerOptions& options, const View& view) {
  const int width = options.width > 0 ? options.width : view.width;
  const int height =
      options.height > 0
          ? options.height
          : std::max(1, static_cast<int>(std::lround(1.0 * width * view.height /
                                                     view.width)));
  return CropView(view, options.zoom, options.center_u, options.center_v, width,
                  height);
}

// The size of pictures that are not from a camera of the workspace.
Eigen::Vector2i FreeSize(const ViewerOptions& options) {
  const int width = options.width > 0 ? options.width : ViewerOptions::kWidth;
  return {width,
          options.height > 0 ? options.height : std::max(1, width * 3 / 4)};
}

}  // namespace

size_t FindView(const std::vector<View>& views, const std::string& name) {
  const auto found = std::ranges::find(views, name, &View::name);
  if (found == views.end()) {
    throw OptionError("--image_name: the workspace has no image " + name +
                      (views.empty()
                           ? ", nor any other"
                           : "; one that it has is " + views.front().name));
  }
  return found - views.begin();
}

std::vector<Screenshot> PlanScreenshots(const ViewerOptions& options,
                                        const ShownScene& scene) {
  const std::filesystem::path path = options.screenshot_path;
  if (!options.image_name.empty()) {
    return {
        {path, Crop(options,
                    scene.views[FindView(scene.views, options.image_name)])}};
  }
  const Eigen::Vector2i size = FreeSize(options);
  OrbitCamera camera = FirstCamera(*scene.meshes[0], size.x(), size.y());
  const auto picture = [&] {
    return Crop(options, camera.Picture(size.x(), size.y()));
  };
  if (options.turntable == 0) {
    return {{path, picture()}};
  }
  const Eigen::Vector3d axis = Upwards(scene.views, picture());
  std::vector<Screenshot> screenshots;
  for (int i = 0; i < options.turntable; ++i) {
    screenshots.push_back(
        {std::filesystem::path(path).replace_extension(
             fmt::format(".{:03}{}", i, path.extension().string())),
         picture()});
    camera.Turn(2 * std::numbers::pi / options.turntable, axis);
  }
  return screenshots;
}

std::string DrawScreenshots(
    const ViewerOptions& options, const ShownScene& scene,
    const std::vector<Screenshot>& screenshots,
    const std::function<void(const std::filesystem::path&, const ColorImage&)>&
        write) {
  const EglContext context(options.gpu_index);
  const EglContext::Scope scope = context.MakeCurrent();
  SceneRenderer renderer;
  DrawSettings settings = options.settings;
  if (options.image_opacity > 0) {
    settings.image = FindView(scene.views, options.image_name);
    settings.image_opacity = options.image_opacity;
  }
  for (const Screenshot& screenshot : screenshots) {
    renderer.Draw(scene, screenshot.view, settings);
    write(screenshot.path, renderer.Read());
  }
  return context.RendererName();
}

}  // namespace colmap_ext
