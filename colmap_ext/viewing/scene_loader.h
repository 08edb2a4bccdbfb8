#pragma once

#include <cstddef>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "colmap_ext/options/viewer_options.h"
#include "scene/images.h"
#include "scene/view.h"
#include "viewer/background_worker.h"
#include "viewer/shown_scene.h"
#include "viewer/viewer_session.h"

namespace colmap_ext {

// Reads a mesh or cloud, and its .vis if there is one; the part of it in the
// region of the options, if they have one. Skips facets with a vertex that is
// not finite. Uses labels and errors, at their paths in the options, of a mesh
// with the same number of facets or vertices.
// \param notes  gets a line for each file that does not fit the mesh.
// \throw FileError if a file cannot be read.
ShownMesh ReadShownMesh(const std::filesystem::path& path,
                        const ViewerOptions& options,
                        std::vector<std::string>* notes);

// Paths of the viewer's input.
struct ViewerPaths {
  std::filesystem::path folder;  // the dense workspace; empty: none
  std::vector<std::filesystem::path> meshes;
};

// \throw FileError if there are several workspaces, or no mesh.
ViewerPaths FindViewerPaths(const ViewerOptions& options);

// Reads the points and views of a workspace, and notes on unusable files: the
// fused points and the cameras in their order; if that fails, the sparse model;
// if that fails too, nothing.
ShownScene ReadViewerWorkspace(const ViewerOptions& options,
                               const ViewerPaths& paths,
                               const PictureDecoder& decoder);

// An image of at most `max_size` px a side; nullptr if it cannot be read.
std::shared_ptr<const ColorImage> ReadShownImage(
    const std::filesystem::path& folder, const View& view, int max_size,
    const PictureDecoder& decoder);

inline constexpr int kThumbnailSize = 192;  // px a side; chosen by hand
inline constexpr int kImageSize = 2048;     // px a side of images over meshes

// The index of the view with the name.
// \throw OptionError if there is none.
size_t FindView(const std::vector<View>& views, const std::string& name);

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

  // The viewer's callbacks into the loader. Pictures are saved in the current
  // folder, under the first unused name "mesh_viewer.NNN.png".
  ViewerHost Host();

 private:
  void LoadMesh(const std::filesystem::path& path,
                const ViewerOptions& options);
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

}  // namespace colmap_ext
