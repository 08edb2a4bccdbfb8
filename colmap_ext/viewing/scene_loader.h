#pragma once

#include <cstddef>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "colmap_ext/options/viewer_options.h"
#include "colmap_ext/viewing/viewer_workspace.h"
#include "scene/picture_decoder.h"
#include "viewer/background_worker.h"
#include "viewer/shown_scene.h"
#include "viewer/viewer_session.h"

namespace colmap_ext {

// Loads the scene of the viewer on a separate thread into its inbox.
class SceneLoader {
 public:
  // \param inbox  has to outlive the loader.
  SceneLoader(ViewerPaths paths, PictureDecoder decoder, SceneInbox* inbox)
      : paths_(std::move(paths)),
        decoder_(std::move(decoder)),
        inbox_(inbox),
        worker_([this](const std::exception& error) { NoteError(error); }) {}

  // Loads the meshes, then the workspace.
  void LoadAll(const ViewerOptions& options);

  // The viewer's callbacks into the loader.
  // \param save  saves a picture; see ViewerHost.
  ViewerHost Host(std::function<std::string(const ColorImage&)> save);

 private:
  void LoadMesh(const ShownMeshPaths& paths);
  void AddStandIn(const std::shared_ptr<const ShownMesh>& mesh);
  void LoadWorkspace(const ViewerOptions& options);
  void LoadImage(size_t index, const View& view);
  void LoadThumbnails(const std::vector<View>& views);
  void Match(const std::shared_ptr<const ShownMesh>& mesh, uint32_t facet,
             const View& first, const View& second);
  void Say(const std::string& status);
  void Note(const std::vector<std::string>& notes);
  void NoteError(const std::exception& error);

  // Used only by the worker's thread once there are jobs.
  ViewerPaths paths_;
  PictureDecoder decoder_;
  std::vector<std::string> notes_;
  size_t num_meshes_ = 0;

  SceneInbox* inbox_;
  BackgroundWorker worker_;  // last, because its jobs use the others
};

// Saves a picture in the current folder under the first unused name.
// \return the outcome, in one line.
std::string SaveNumbered(const ColorImage& picture,
                         const std::function<void(const std::filesystem::path&,
                                                  const ColorImage&)>& write);

}  // namespace colmap_ext
