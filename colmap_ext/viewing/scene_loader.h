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
#include "viewer/scene_inbox.h"
#include "viewer/viewer_host.h"

namespace colmap_ext {

// Loads what the viewer shows, on a thread of its own, into its inbox.
class SceneLoader {
 public:
  // \param inbox  has to outlive it.
  SceneLoader(ViewerPaths paths, PictureDecoder decoder, SceneInbox* inbox)
      : paths_(std::move(paths)),
        decoder_(std::move(decoder)),
        inbox_(inbox),
        worker_([this](const std::exception& error) { NoteError(error); }) {}

  // The meshes, and then the workspace.
  void LoadAll(const ViewerOptions& options);

  // What it does for the viewer.
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

  // Used by the worker's thread alone, once it has jobs.
  ViewerPaths paths_;
  PictureDecoder decoder_;
  std::vector<std::string> notes_;
  size_t num_meshes_ = 0;

  SceneInbox* inbox_;
  BackgroundWorker worker_;  // The last, as it uses the others.
};

// Saves a picture in the present folder under the first name that is free.
// \return what became of it.
std::string SaveNumbered(const ColorImage& picture,
                         const std::function<void(const std::filesystem::path&,
                                                  const ColorImage&)>& write);

}  // namespace colmap_ext
