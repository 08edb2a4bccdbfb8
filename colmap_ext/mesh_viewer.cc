#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/commands.h"
#include "colmap_ext/errors.h"
#include "colmap_ext/options/viewer_options.h"
#include "colmap_ext/run_command.h"
#include "colmap_ext/viewing/draw_screenshots.h"
#include "colmap_ext/viewing/scene_loader.h"
#include "colmap_ext/viewing/viewer_workspace.h"
#include "formats/encode_png.h"
#include "viewer/shown_mesh.h"
#include "viewer/shown_scene.h"
#include "viewer/viewer_session.h"
#include "workspace/find_workspace.h"

namespace colmap_ext {

namespace {

CommandAdvice Advice() {
  return {"look at fewer meshes at a time",
          "the mesh",
          {{Alternative::kSayImageOrder, "; say it with --image_order"},
           {Alternative::kOtherImageOrder, "; choose another --image_order"}}};
}

void PrintNotes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    std::cout << "NOTE: " << note << "\n";
  }
}

// All that a picture shows.
ShownScene ReadScene(const ViewerOptions& options, const ViewerPaths& paths,
                     const PictureDecoder& decoder) {
  ShownScene scene;
  std::vector<std::string> notes;
  scene.meshes.push_back(std::make_shared<const ShownMesh>(
      ReadShownMesh(paths.meshes[0], &notes)));
  ViewerWorkspace workspace = ReadViewerWorkspace(options, paths, decoder);
  scene.views = std::move(workspace.views);
  scene.points = std::move(workspace.points);
  notes.insert(notes.end(), workspace.notes.begin(), workspace.notes.end());
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
                      "can not be read");
    }
  }
  PrintNotes(notes);
  return scene;
}

void TakeScreenshots(const ViewerOptions& options, const ViewerPaths& paths) {
  const ShownScene scene = ReadScene(options, paths, ColmapPictureDecoder());
  const std::vector<Screenshot> screenshots = PlanScreenshots(options, scene);
  std::vector<std::filesystem::path> outputs;
  for (const Screenshot& screenshot : screenshots) {
    outputs.push_back(screenshot.path);
  }
  std::vector<std::filesystem::path> inputs;
  if (!paths.folder.empty()) {
    inputs = WorkspaceInputs(paths.folder, {}, options.sparse_path);
  }
  for (const ShownMeshPaths& mesh : paths.meshes) {
    inputs.insert(inputs.end(), {mesh.mesh, mesh.labels, mesh.errors});
  }
  ExpectOutputs(outputs, inputs);
  const std::string renderer =
      DrawScreenshots(options, scene, screenshots, &WritePng);
  for (const Screenshot& screenshot : screenshots) {
    std::cout << "Wrote " << screenshot.path.string() << "\n";
  }
  std::cout << "Drawn by " << renderer << std::endl;
}

void OpenWindow(const ViewerOptions& options, ViewerPaths paths) {
  const std::string title = "mesh_viewer " + paths.meshes[0].mesh.string();
  SceneInbox inbox;
  SceneLoader loader(std::move(paths), ColmapPictureDecoder(), &inbox);
  ViewerSession session(&inbox, loader.Host([](const ColorImage& picture) {
    return SaveNumbered(picture, &WritePng);
  }),
                        options.settings);
  loader.LoadAll(options);
  const int width = options.width > 0 ? options.width : ViewerOptions::kWidth;
  const int height =
      options.height > 0 ? options.height : std::max(1, width * 3 / 4);
  try {
    RunViewerWindow({title, width, height}, &session);
  } catch (const NoWindowError& error) {
    throw OptionError(
        error.what() +
        std::string("; --screenshot_path FILE.png draws without one"));
  }
}

void LookAtMeshes(const ViewerOptions& options) {
  ViewerPaths paths = FindViewerPaths(options);
  if (options.screenshot_path.empty()) {
    OpenWindow(options, std::move(paths));
  } else {
    TakeScreenshots(options, paths);
  }
}

}  // namespace

int RunMeshViewer(int argc, char** argv) {
  constexpr int kAllThreads = -1;
  ViewerOptions options;
  CommandOptions command;
  AddViewerOptions(&command, &options);
  const CommandSteps steps = {[&options] { options.Finish(); }, &kAllThreads,
                              [&options] { LookAtMeshes(options); }};
  return RunCommand(argc, argv, command, steps, Advice());
}

}  // namespace colmap_ext
