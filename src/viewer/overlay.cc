#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <string>

#include <fmt/format.h>

#include "viewer/glfw_window.h"
#include "viewer/scene_renderer.h"

namespace colmap_ext {
namespace {

constexpr float kMargin = 10;      // px
constexpr float kMatchSize = 192;  // px on the screen

constexpr ImGuiWindowFlags kPlainPanel =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
    ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoMove;

// A panel in a corner: 0 or 1 of the width and height.
void BeginPanel(const char* name, float x, float y, ImGuiWindowFlags more) {
  constexpr float kOpacity = 0.72F;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(
      {x > 0 ? size.x - kMargin : kMargin, y > 0 ? size.y - kMargin : kMargin},
      ImGuiCond_Always, {x, y});
  ImGui::SetNextWindowBgAlpha(kOpacity);
  ImGui::Begin(name, nullptr, kPlainPanel | more);
}

GlTexture GrayTexture(const GrayImage& gray) {
  ColorImage image{gray.width, gray.height, {}};
  for (const uint8_t value : gray.pixels) {
    image.pixels.push_back({value, value, value});
  }
  return ImageTexture(image);
}

void DrawTexture(const GlTexture& texture, const std::string& title) {
  ImGui::BeginGroup();
  ImGui::TextUnformatted(title.c_str());
  ImGui::Image(
      reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(texture.Name())),
      {kMatchSize, kMatchSize});
  ImGui::EndGroup();
}

std::string NamesOf(const std::vector<uint32_t>& views,
                    const ShownScene& scene) {
  constexpr size_t kMaxNames = 8;
  std::string names;
  for (size_t i = 0; i < std::min(views.size(), kMaxNames); ++i) {
    names += (i == 0 ? "" : ", ") + (views[i] < scene.views.size()
                                         ? scene.views[views[i]].name
                                         : std::to_string(views[i]));
  }
  return names + (views.size() > kMaxNames ? ", ..." : "");
}

}  // namespace

Overlay::Overlay(const GlfwWindow& window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // No settings file.
  ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
  ImGui::StyleColorsDark();
  ImGui_ImplGlfw_InitForOpenGL(window.Get(), true);
  ImGui_ImplOpenGL3_Init("#version 450 core");
}

Overlay::~Overlay() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void Overlay::Draw(const ViewerSession& session) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  DrawLines(session);
  if (session.IsHelpShown()) {
    DrawHelp();
  }
  if (session.GetPicked()) {
    DrawPicked(session);
  }
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Overlay::DrawLines(const ViewerSession& session) {
  BeginPanel("lines", 0, 0, ImGuiWindowFlags_NoInputs);
  for (const std::string& line : session.Lines()) {
    ImGui::TextUnformatted(line.c_str());
  }
  if (!session.IsHelpShown()) {
    ImGui::TextDisabled("H: help");
  }
  ImGui::End();
}

void Overlay::DrawHelp() {
  BeginPanel("help", 0, 1, ImGuiWindowFlags_NoInputs);
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    const auto row = [](const char* name, const char* help) {
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(name);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(help);
    };
    for (const auto& [name, help] : kMouseActions) {
      row(name, help);
    }
    for (const KeyAction& action : ViewerSession::KeyActions()) {
      row(action.name, action.help);
    }
    ImGui::EndTable();
  }
  ImGui::End();
}

void Overlay::DrawPicked(const ViewerSession& session) {
  const ViewerSession::Picked& picked = *session.GetPicked();
  const ShownScene& scene = session.Scene();
  BeginPanel("picked", 1, 0, ImGuiWindowFlags_NoInputs);
  ImGui::PushTextWrapPos(2 * kMatchSize);
  ImGui::Text("face %u", picked.facet);
  if (!picked.views.empty()) {
    ImGui::TextWrapped("seen by %zu: %s", picked.views.size(),
                       NamesOf(picked.views, scene).c_str());
  }
  if (!picked.pair) {
    ImGui::TextUnformatted(picked.is_by_label
                               ? "no pair refines it"
                               : "no two views are known to see it");
  } else {
    ImGui::Text(
        "%s: %s", picked.is_by_label ? "refined by" : "seen best by",
        NamesOf({picked.pair->first, picked.pair->second}, scene).c_str());
    if (const auto match = session.PickedMatch()) {
      DrawMatch(match);
    } else {
      ImGui::TextUnformatted("its images are being compared");
    }
  }
  ImGui::PopTextWrapPos();
  ImGui::End();
}

void Overlay::DrawMatch(const std::shared_ptr<const FacetMatch>& match) {
  if (match->first.pixels.empty()) {
    ImGui::TextUnformatted("its images cannot be compared");
    return;
  }
  if (!textures_ || textures_->match != match) {
    textures_ = MatchTextures{match, GrayTexture(match->first),
                              GrayTexture(match->warped)};
  }
  DrawTexture(textures_->first, "first image");
  ImGui::SameLine();
  DrawTexture(textures_->warped, "second, warped");
  ImGui::TextUnformatted(
      match->zncc ? fmt::format("ZNCC {:.3f}", *match->zncc).c_str()
                  : "ZNCC: it is hidden in one image, or without texture");
}

}  // namespace colmap_ext
