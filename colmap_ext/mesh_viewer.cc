#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/commands.h"
#include "colmap_ext/options/viewer_options.h"
#include "colmap_ext/run_command.h"
#include "colmap_ext/viewing/scene_loader.h"
#include "formats/picture_files.h"
#include "gl/egl_context.h"
#include "pictures/pictures.h"
#include "viewer/orbit_camera.h"
#include "viewer/scene_renderer.h"
#include "viewer/shown_scene.h"
#include "viewer/viewer_session.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {
namespace {

// All that a picture shows.
ShownScene ReadScene(const ViewerOptions& options, const ViewerPaths& paths,
                     const PictureDecoder& decoder) {
  std::vector<std::string> notes;
  auto mesh = std::make_shared<const ShownMesh>(
      ReadShownMesh(paths.meshes[0], options, &notes));
  ShownScene scene = ReadViewerWorkspace(options, paths, decoder);
  scene.meshes.push_back(std::move(mesh));
  notes.insert(notes.end(), scene.notes.begin(), scene.notes.end());
  if (const std::string missing =
          MissingData(*scene.meshes[0], options.settings.mode);
      !missing.empty()) {
    notes.push_back(missing);
  }
  for (size_t i = 0; options.settings.cameras && i < scene.views.size(); ++i) {
    if (auto image = ReadShownImage(paths.folder, scene.views[i],
                                    kThumbnailSize, decoder)) {
      scene.thumbnails[i] = std::move(image);
    }
  }
  if (options.image_opacity > 0) {
    const size_t view = FindView(scene.views, options.image_name);
    scene.images[view] =
        ReadShownImage(paths.folder, scene.views[view], kImageSize, decoder);
    if (scene.images[view] == nullptr) {
      throw FileError(paths.folder / "images" / options.image_name,
                      "cannot be read");
    }
  }
  for (const std::string& note : notes) {
    std::cout << "NOTE: " << note << "\n";
  }
  return scene;
}

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

// The cameras of the requested pictures, by the pictures' paths.
using Screenshots = std::map<std::filesystem::path, View>;

// \throw OptionError if there is no such camera.
Screenshots PlanScreenshots(const ViewerOptions& options,
                            const ShownScene& scene) {
  const std::filesystem::path path = options.screenshot_path;
  if (!options.image_name.empty()) {
    return {
        {path, Crop(options,
                    scene.views[FindView(scene.views, options.image_name)])}};
  }
  const std::array<int, 2> size = options.FreeSize();
  OrbitCamera camera = FirstCamera(*scene.meshes[0], size[0], size[1]);
  const auto picture = [&] {
    return Crop(options, camera.Picture(size[0], size[1]));
  };
  if (options.turntable == 0) {
    return {{path, picture()}};
  }
  const Eigen::Vector3d axis = Upwards(scene.views, picture());
  Screenshots screenshots;
  for (int i = 0; i < options.turntable; ++i) {
    screenshots[std::filesystem::path(path).replace_extension(
        fmt::format(".{:03}{}", i, path.extension().string()))] = picture();
    camera.Turn(2 * std::numbers::pi / options.turntable, axis);
  }
  return screenshots;
}

// Draws pictures by OpenGL without a display.
// \return OpenGL's name of the renderer.
// \throw GlError if there is no OpenGL 4.5, or it fails.
std::string DrawScreenshots(const ViewerOptions& options,
                            const ShownScene& scene,
                            const Screenshots& screenshots) {
  const EglContext context(options.gpu_index);
  const EglContext::Scope scope = context.MakeCurrent();
  SceneRenderer renderer;
  DrawSettings settings = options.settings;
  if (options.image_opacity > 0) {
    settings.image = FindView(scene.views, options.image_name);
    settings.image_opacity = options.image_opacity;
  }
  for (const auto& [path, view] : screenshots) {
    renderer.Draw(scene, view, settings);
    WritePng(path, renderer.Read());
  }
  return context.RendererName();
}

void TakeScreenshots(const ViewerOptions& options, const ViewerPaths& paths) {
  const ShownScene scene = ReadScene(options, paths, ColmapPictureDecoder());
  const Screenshots screenshots = PlanScreenshots(options, scene);
  std::vector<std::filesystem::path> outputs;
  for (const auto& [path, view] : screenshots) {
    outputs.push_back(path);
  }
  std::vector<std::filesystem::path> inputs = paths.meshes;
  inputs.insert(inputs.end(), {options.labels_path, options.error_mesh_path});
  ExpectOutputs(outputs, WorkspaceInputs(paths.folder, {}, options.sparse_path,
                                         std::move(inputs)));
  const std::string renderer = DrawScreenshots(options, scene, screenshots);
  for (const std::filesystem::path& path : outputs) {
    std::cout << "Wrote " << path.string() << "\n";
  }
  std::cout << "Drawn by " << renderer << std::endl;
}

void OpenWindow(const ViewerOptions& options, ViewerPaths paths) {
  const std::string title = "mesh_viewer " + paths.meshes[0].string();
  SceneInbox inbox;
  SceneLoader loader(std::move(paths), ColmapPictureDecoder(), &inbox);
  ViewerSession session(&inbox, loader.Host(), options.settings);
  loader.LoadAll(options);
  const auto [width, height] = options.FreeSize();
  try {
    RunViewerWindow({title, width, height}, &session);
  } catch (const NoWindowError& error) {
    throw OptionError(
        error.what() +
        std::string("; --screenshot_path FILE.png draws without one"));
  }
}

void LookAtMeshes(const ViewerOptions& options, Console* /*console*/) {
  ViewerPaths paths = FindViewerPaths(options);
  if (options.screenshot_path.empty()) {
    OpenWindow(options, std::move(paths));
  } else {
    TakeScreenshots(options, paths);
  }
}

}  // namespace

int RunMeshViewer(int argc, char** argv) {
  return RunCommand(argc, argv, &AddViewerOptions, &LookAtMeshes,
                    {"look at fewer meshes at a time", "the mesh"});
}

}  // namespace colmap_ext
