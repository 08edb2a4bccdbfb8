#include "viewer/viewer_session.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/indices.h"

namespace colmap_ext {
namespace {

constexpr double kFlightTime = 0.4;  // seconds; chosen by hand

// Starts and ends slowly.
double Ease(double share) { return share * share * (3 - 2 * share); }

// Views in the order of the names of their images.
std::vector<uint32_t> ByName(const std::vector<View>& views) {
  std::vector<uint32_t> order = Iota(views.size());
  std::ranges::stable_sort(order, {}, [&](uint32_t view) -> const std::string& {
    return views[view].name;
  });
  return order;
}

}  // namespace

ViewerSession::ViewerSession(SceneInbox* inbox, ViewerHost host,
                             DrawSettings settings)
    : inbox_(inbox), host_(std::move(host)), settings_(settings) {}

bool ViewerSession::Update(double seconds) {
  seconds_ = seconds;
  bool has_changed = inbox_->Take(&scene_);
  if (!camera_ && !scene_.meshes.empty()) {
    first_camera_ = FirstCamera(*scene_.meshes[0], width_, height_);
    camera_ = first_camera_;
  }
  if (picked_ && scene_.meshes[settings_.mesh] != picked_mesh_) {
    picked_.reset();  // the mesh has changed
    settings_.picked.reset();
  }
  if (settings_.cameras && !scene_.views.empty() && host_.load_thumbnails &&
      !std::exchange(are_thumbnails_asked_, true)) {
    host_.load_thumbnails(scene_.views);
  }
  if (flight_) {
    has_changed = true;
    Fly(seconds);
  }
  return has_changed;
}

void ViewerSession::Fly(double seconds) {
  const double share = (seconds - flight_->start) / kFlightTime;
  camera_ = flight_->to;
  if (share < 1) {
    camera_ = OrbitCamera(
        BetweenViews(flight_->from.Picture(width_, height_),
                     flight_->to.Picture(width_, height_), Ease(share)),
        flight_->to.Pivot());
  } else {
    flight_.reset();
  }
}

void ViewerSession::SetSize(int width, int height) {
  width_ = std::max(width, 1);
  height_ = std::max(height, 1);
}

void ViewerSession::Press(int key) {
  message_.clear();
  for (const KeyAction& action : KeyActions()) {
    if (std::ranges::find(action.keys, key) != action.keys.end()) {
      action.act(this);
    }
  }
}

void ViewerSession::Drag(DragKind kind, const Eigen::Vector2d& from,
                         const Eigen::Vector2d& to) {
  if (!camera_ || from == to) {
    return;
  }
  LeaveView();
  if (kind == DragKind::kRotate) {
    camera_->Orbit(from, to, width_, height_);
  } else {
    camera_->Pan(from, to, width_, height_);
  }
}

void ViewerSession::Scroll(double steps) {
  if (camera_) {
    LeaveView();
    camera_->Zoom(steps);
  }
}

void ViewerSession::Pick(uint32_t facet) {
  picked_.reset();
  settings_.picked.reset();
  scene_.matches.clear();
  if (facet == kNone || settings_.mesh >= scene_.meshes.size()) {
    return;
  }
  picked_mesh_ = scene_.meshes[settings_.mesh];
  if (facet >= picked_mesh_->mesh.facets.size()) {
    return;
  }
  settings_.picked = facet;
  picked_ = Picked{facet, ViewsOfFacet(*picked_mesh_, facet),
                   PairOfFacet(*picked_mesh_, facet, scene_.views),
                   !picked_mesh_->labels.empty()};
  if (picked_->pair && host_.match_facet) {
    host_.match_facet(picked_mesh_, facet, scene_.views[picked_->pair->first],
                      scene_.views[picked_->pair->second]);
  }
}

std::shared_ptr<const FacetMatch> ViewerSession::PickedMatch() const {
  if (!picked_) {
    return nullptr;
  }
  const auto match = scene_.matches.find({picked_mesh_, picked_->facet});
  return match != scene_.matches.end() ? match->second : nullptr;
}

std::optional<View> ViewerSession::Picture() const {
  return camera_ ? std::optional(camera_->Picture(width_, height_))
                 : std::nullopt;
}

void ViewerSession::FlyTo(const OrbitCamera& camera) {
  if (camera_) {
    flight_ = Flight{*camera_, camera, seconds_};
  }
}

void ViewerSession::GoToView(size_t view) {
  const Eigen::Vector3d pivot =
      camera_ ? camera_->Pivot() : Eigen::Vector3d(0, 0, 0);
  FlyTo({scene_.views[view], PivotBefore(scene_.views[view], pivot)});
  at_view_ = view;
  if (settings_.image) {
    SetImage(true);
  }
}

void ViewerSession::StepView(int step) {
  const auto count = static_cast<int>(scene_.views.size());
  if (count == 0) {
    message_ = "there are no cameras";
    return;
  }
  const std::vector<uint32_t> order = ByName(scene_.views);
  int place = step > 0 ? -1 : 0;  // of the one before the first
  if (at_view_) {
    place =
        static_cast<int>(std::ranges::find(order, *at_view_) - order.begin());
  }
  GoToView(order[(place + step + count) % count]);
}

void ViewerSession::SetImage(bool is_shown) {
  settings_.image.reset();
  if (!is_shown) {
    return;
  }
  if (!at_view_) {
    message_ = "go to a camera first: Left, Right";
    return;
  }
  settings_.image = at_view_;
  if (!scene_.images.contains(*at_view_) && host_.load_image) {
    host_.load_image(*at_view_, scene_.views[*at_view_]);
  }
}

void ViewerSession::LeaveView() {
  at_view_.reset();
  flight_.reset();
  settings_.image.reset();
}

void ViewerSession::SavePicture(const ColorImage& picture) {
  if (host_.save_picture) {
    message_ = host_.save_picture(picture);
  }
}

std::string ViewerSession::CameraLine() const {
  if (!at_view_) {
    return fmt::format("{} cameras", scene_.views.size());
  }
  std::string line = "camera " + scene_.views[*at_view_].name;
  if (settings_.image) {
    line += scene_.images.contains(*settings_.image)
                ? fmt::format(", image {:.0f} %", 100 * settings_.image_opacity)
                : ", its image is being read";
  }
  return line;
}

std::vector<std::string> ViewerSession::Lines() const {
  std::vector<std::string> lines;
  if (settings_.mesh < scene_.meshes.size()) {
    const ShownMesh& mesh = *scene_.meshes[settings_.mesh];
    lines.push_back(fmt::format("{}: {} faces, {} vertices ({} of {})",
                                mesh.name, mesh.mesh.facets.size(),
                                mesh.mesh.vertices.size(), settings_.mesh + 1,
                                scene_.meshes.size()));
    const std::string missing = MissingData(mesh, settings_.mode);
    lines.push_back(missing.empty() ? NameOf(settings_.mode) : missing);
    lines.push_back(CameraLine());
  }
  for (const std::string& line : {scene_.status, message_}) {
    if (!line.empty()) {
      lines.push_back(line);
    }
  }
  Append(scene_.notes, &lines);
  return lines;
}

void ViewerSession::ChangeOpacity(double change) {
  double& opacity = settings_.image_opacity;
  opacity = std::clamp(opacity + change, 0.0, 1.0);
}

void ViewerSession::NextMesh() {
  if (!scene_.meshes.empty()) {
    settings_.mesh = (settings_.mesh + 1) % scene_.meshes.size();
    settings_.picked.reset();
    picked_.reset();
  }
}

void ViewerSession::Reset() {
  LeaveView();
  if (first_camera_) {
    FlyTo(*first_camera_);
  }
}

void ViewerSession::Pause() {
  if (!host_.pause) {
    message_ = "there is no refinement to pause";
    return;
  }
  is_paused_ = !is_paused_;
  host_.pause(is_paused_);
  message_ = is_paused_ ? "paused; T continues" : "";
}

std::vector<KeyAction> ViewerSession::MakeKeyActions() {
  constexpr double kStep = 0.1;  // of the opacity
  std::vector<KeyAction> all;
  const auto add = [&all](std::vector<int> keys, const char* name,
                          const char* help, const auto& act) {
    all.push_back({std::move(keys), name, help, act});
  };
  const auto add_mode = [&](int key, MeshMode mode, const char* help) {
    static constexpr const char* kNames[] = {"1", "2", "3", "4", "5", "6"};
    add({key}, kNames[key - '1'], help,
        [mode](ViewerSession* session) { session->settings_.mode = mode; });
  };
  const auto add_toggle = [&](const char* name, bool DrawSettings::*setting,
                              const char* help) {
    add({name[0]}, name, help, [setting](ViewerSession* session) {
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
      [](ViewerSession* session) { session->StepView(1); });
  add({kKeyLeft, '['}, "Left [", "previous camera",
      [](ViewerSession* session) { session->StepView(-1); });
  add({'G'}, "G", "the camera's image over the mesh",
      [](ViewerSession* session) {
        session->SetImage(!session->settings_.image);
      });
  add({'+', '='}, "+", "increase its opacity",
      [](ViewerSession* session) { session->ChangeOpacity(kStep); });
  add({'-'}, "-", "decrease its opacity",
      [](ViewerSession* session) { session->ChangeOpacity(-kStep); });
  add({kKeyTab}, "Tab", "next mesh", &ViewerSession::NextMesh);
  add({'R'}, "R", "first view", &ViewerSession::Reset);
  add({'S'}, "S", "save a picture",
      [](ViewerSession* session) { session->wants_screenshot_ = true; });
  add({'T'}, "T", "pause or continue the refinement", &ViewerSession::Pause);
  add({'H'}, "H", "this help", [](ViewerSession* session) {
    session->is_help_shown_ = !session->is_help_shown_;
  });
  add({kKeyEscape}, "Esc", "close",
      [](ViewerSession* session) { session->is_closed_ = true; });
  return all;
}

const std::vector<KeyAction>& ViewerSession::KeyActions() {
  static const std::vector<KeyAction> actions = MakeKeyActions();
  return actions;
}

}  // namespace colmap_ext
