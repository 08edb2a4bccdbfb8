#include "viewer/viewer_session.h"

namespace colmap_ext {

void RunViewerWindow(const WindowOptions& /*options*/,
                     ViewerSession* /*session*/) {
  throw NoWindowError(
      "No window: this program was built without GLFW and Dear ImGui "
      "(libglfw3-dev, libimgui-dev)");
}

}  // namespace colmap_ext
