#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/view.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// Shows a running refinement: the refinement passes copies to the viewer, and
// the viewer can only pause it.
class LiveView {
 public:
  // Shows the input mesh, the cameras and the points.
  void Start(const TriangleMesh& mesh, const VertexAttributes& attributes,
             const std::vector<View>& views, const PointCloud& points);

  // Shows the current mesh.
  // \param status  the last iteration, in one line
  void Show(const TriangleMesh& mesh, const VertexAttributes& attributes,
            const std::string& status);
  void Say(const std::string& status);

  // Returns when the refinement may continue.
  // \param should_stop  polled meanwhile.
  void WaitWhilePaused(const std::function<bool()>& should_stop);

  // Called by the viewer's thread.
  void Pause(bool is_paused) { is_paused_ = is_paused; }
  // Called when the window is closed.
  void Leave();
  SceneInbox* Inbox() { return &inbox_; }

 private:
  SceneInbox inbox_;
  std::atomic<bool> is_paused_ = false;
  std::atomic<bool> is_watched_ = true;
};

// Runs work on a separate thread and shows it in a window, until both have
// ended. When the window is closed, the work continues.
// \param folder  of the workspace, for its images.
// \throw NoWindowError if no window can be opened, before the work starts;
//        exceptions of the work.
void RunWithViewer(const std::string& title, const std::string& folder,
                   const PictureDecoder& decoder,
                   const std::function<void(LiveView*)>& work);

}  // namespace colmap_ext
