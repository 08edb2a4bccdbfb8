// The actions of keys and mouse: the table from which the help is printed.

#include <algorithm>
#include <utility>

#include "viewer/viewer_session.h"

namespace colmap_ext {

// The actions; they have access to the session's members.
struct ViewerActions {
  using Session = ViewerSession;

  static void Opacity(Session* session, double change) {
    double& opacity = session->settings_.image_opacity;
    opacity = std::clamp(opacity + change, 0.0, 1.0);
  }

  static void NextMesh(Session* session) {
    const size_t count = session->scene_.meshes.size();
    if (count > 0) {
      session->settings_.mesh = (session->settings_.mesh + 1) % count;
      session->settings_.picked.reset();
      session->picked_.reset();
    }
  }

  static void Reset(Session* session) {
    session->LeaveView();
    if (session->first_camera_) {
      session->FlyTo(*session->first_camera_);
    }
  }

  static void Pause(Session* session) {
    if (!session->host_.pause) {
      session->message_ = "there is no refinement to pause";
      return;
    }
    session->is_paused_ = !session->is_paused_;
    session->host_.pause(session->is_paused_);
    session->message_ = session->is_paused_ ? "paused; T continues" : "";
  }

  static std::vector<KeyAction> All() {
    constexpr double kStep = 0.1;  // of the opacity
    std::vector<KeyAction> all;
    const auto add = [&all](std::vector<int> keys, const char* name,
                            const char* help, const auto& act) {
      all.push_back({std::move(keys), name, help, act});
    };
    const auto add_mode = [&](int key, MeshMode mode, const char* help) {
      static constexpr const char* kNames[] = {"1", "2", "3", "4", "5", "6"};
      add({key}, kNames[key - '1'], help,
          [mode](Session* session) { session->settings_.mode = mode; });
    };
    const auto add_toggle = [&](const char* name, bool DrawSettings::*setting,
                                const char* help) {
      add({name[0]}, name, help, [setting](Session* session) {
        session->settings_.*setting = !(session->settings_.*setting);
      });
    };
    add_mode('1', MeshMode::kShaded, "shaded");
    add_mode('2', MeshMode::kColor, "colors of the vertices");
    add_mode('3', MeshMode::kNormals, "normals");
    add_mode('4', MeshMode::kLabels, "labels: the image pair of each face");
    add_mode('5', MeshMode::kErrors, "errors");
    add_mode('6', MeshMode::kConfidence, "confidence");
    add_toggle("W", &DrawSettings::wireframe, "wireframe");
    add_toggle("B", &DrawSettings::backfaces, "mark back sides of faces");
    add_toggle("P", &DrawSettings::points, "points");
    add_toggle("C", &DrawSettings::cameras, "cameras with their images");
    add({kKeyRight, ']'}, "Right ]", "next camera",
        [](Session* session) { session->StepView(1); });
    add({kKeyLeft, '['}, "Left [", "previous camera",
        [](Session* session) { session->StepView(-1); });
    add({'G'}, "G", "the camera's image over the mesh",
        [](Session* session) { session->SetImage(!session->settings_.image); });
    add({'+', '='}, "+", "increase its opacity",
        [](Session* session) { Opacity(session, kStep); });
    add({'-'}, "-", "decrease its opacity",
        [](Session* session) { Opacity(session, -kStep); });
    add({kKeyTab}, "Tab", "next mesh", &NextMesh);
    add({'R'}, "R", "first view", &Reset);
    add({'S'}, "S", "save a picture",
        [](Session* session) { session->wants_screenshot_ = true; });
    add({'T'}, "T", "pause or continue the refinement", &Pause);
    add({'H'}, "H", "this help", [](Session* session) {
      session->is_help_shown_ = !session->is_help_shown_;
    });
    add({kKeyEscape}, "Esc", "close",
        [](Session* session) { session->is_closed_ = true; });
    return all;
  }
};

const std::vector<KeyAction>& KeyActions() {
  static const std::vector<KeyAction> actions = ViewerActions::All();
  return actions;
}

}  // namespace colmap_ext
