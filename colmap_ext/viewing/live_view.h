#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "scene/picture_decoder.h"
#include "scene/point_cloud.h"
#include "scene/view.h"
#include "viewer/scene_inbox.h"

namespace colmap_ext {

// Shows a running refinement: the refinement passes copies to the viewer, and
// the viewer can only pause it.
class LiveView {
 public:
  // The mesh as it was, and what the images are of.
  void Start(const TriangleMesh& mesh, const VertexAttributes& attributes,
             const std::vector<View>& views, const PointCloud& points);

  // The mesh as it is now.
  // \param status  what was done, in one line
  void Show(const TriangleMesh& mesh, const VertexAttributes& attributes,
            const std::string& status);
  void Say(const std::string& status);

  // Returns when the refinement may continue.
  // \param should_stop  polled meanwhile.
  void WaitWhilePaused(const std::function<bool()>& should_stop);

  // Called by the viewer's thread.
  void Pause(bool is_paused);
  // The window is closed.
  void Leave();
  SceneInbox* Inbox() { return &inbox_; }

 private:
  SceneInbox inbox_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_paused_ = false;
  std::atomic<bool> is_watched_ = true;
};

// Runs work on a thread of its own beside a window that shows it, until both
// have ended. When the window is closed, the work continues.
// \param folder  of the workspace, for its images.
// \param save  saves a picture, see ViewerHost.
// \throw NoWindowError if there is no window, before the work starts; what the
//        work throws.
void RunWithViewer(const std::string& title, const std::string& folder,
                   const PictureDecoder& decoder,
                   const std::function<std::string(const ColorImage&)>& save,
                   const std::function<void(LiveView*)>& work);

}  // namespace colmap_ext
