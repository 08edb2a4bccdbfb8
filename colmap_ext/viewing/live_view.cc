#include "colmap_ext/viewing/live_view.h"

#include <chrono>
#include <exception>
#include <thread>
#include <utility>

#include "colmap_ext/viewing/scene_loader.h"
#include "viewer/viewer_session.h"

namespace colmap_ext {
namespace {

std::shared_ptr<const ShownMesh> ToShown(const std::string& name,
                                         const TriangleMesh& mesh,
                                         const VertexAttributes& attributes) {
  return std::make_shared<const ShownMesh>(ShownMesh{attributes, name, mesh});
}

}  // namespace

void LiveView::Start(const TriangleMesh& mesh,
                     const VertexAttributes& attributes,
                     const std::vector<View>& views, const PointCloud& points) {
  auto cloud = std::make_shared<PointCloud>();
  cloud->positions = points.positions;
  cloud->colors = points.colors;
  inbox_.Put("1 scene", [before = ToShown("before", mesh, attributes), views,
                         cloud](ShownScene* scene) {
    scene->meshes = {before, before};
    scene->views = views;
    scene->points = cloud;
  });
}

void LiveView::Show(const TriangleMesh& mesh,
                    const VertexAttributes& attributes,
                    const std::string& status) {
  if (!is_watched_) {
    return;
  }
  inbox_.Put("2 mesh", [now = ToShown("refined", mesh, attributes)](
                           ShownScene* scene) { scene->meshes[0] = now; });
  Say(status);
}

void LiveView::Say(const std::string& status) {
  inbox_.Put("3 status",
             [status](ShownScene* scene) { scene->status = status; });
}

void LiveView::WaitWhilePaused(const std::function<bool()>& should_stop) {
  constexpr std::chrono::milliseconds kWait(20);
  while (is_paused_ && !should_stop()) {
    std::this_thread::sleep_for(kWait);
  }
}

void LiveView::Leave() {
  is_watched_ = false;
  is_paused_ = false;
}

void RunWithViewer(const std::string& title, const std::string& folder,
                   const PictureDecoder& decoder,
                   const std::function<void(LiveView*)>& work) {
  LiveView live;
  SceneLoader loader({folder, {}}, decoder, live.Inbox());
  ViewerHost host = loader.Host();
  host.pause = [&live](bool is_paused) { live.Pause(is_paused); };
  ViewerSession session(live.Inbox(), std::move(host), {});
  std::exception_ptr error;
  std::thread thread;
  const auto start = [&] {
    thread = std::thread([&] {
      try {
        work(&live);
        live.Say("the refinement is finished");
      } catch (...) {
        error = std::current_exception();
        live.Inbox()->Put("4 end",
                          [](ShownScene* scene) { scene->is_over = true; });
      }
    });
  };
  std::exception_ptr window_error;
  try {
    RunViewerWindow({.title = title, .on_open = start}, &session);
  } catch (...) {
    window_error = std::current_exception();
  }
  live.Leave();
  if (thread.joinable()) {
    thread.join();
  }
  for (const std::exception_ptr& thrown : {error, window_error}) {
    if (thrown) {
      std::rethrow_exception(thrown);
    }
  }
}

}  // namespace colmap_ext
