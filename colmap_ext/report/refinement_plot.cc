#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/report/refinement_report.h"

namespace colmap_ext {

namespace {

using Steps = std::vector<RefinementStep>;

// All in pixels of the picture.
constexpr double kStepWidth = 24;
constexpr double kMinPanelWidth = 150;
constexpr double kPanelHeight = 200;
constexpr double kMargin = 24;   // around everything, and between panels
constexpr double kPadding = 14;  // of a curve in its panel
constexpr double kTop = 64;      // of the panels
constexpr double kHeight = kTop + kPanelHeight + 48;

double PanelWidth(const Steps& steps) {
  return std::max(
      kMinPanelWidth,
      2 * kPadding + kStepWidth * (static_cast<double>(steps.size()) - 1));
}

std::string Element(const std::string& name, double x, double y,
                    const std::string& attributes, const std::string& text) {
  const std::string start =
      fmt::format("<{} x=\"{:.1f}\" y=\"{:.1f}\" {}", name, x, y, attributes);
  return start +
         (text.empty() ? "/>\n" : fmt::format(">{}</{}>\n", text, name));
}

std::string Text(double x, double y, const char* anchor,
                 const std::string& text) {
  return Element("text", x, y, std::string("text-anchor=\"") + anchor + "\"",
                 text);
}

// The curve of one stage in a panel that starts at `left`.
std::string Panel(const Steps& steps, double left) {
  const auto [low, high] = std::minmax_element(
      steps.begin(), steps.end(),
      [](const auto& a, const auto& b) { return a.energy < b.energy; });
  const double range = std::max(high->energy - low->energy, 1e-300);
  const double width = PanelWidth(steps);
  const double step_width =
      (width - 2 * kPadding) /
      std::max(1.0, static_cast<double>(steps.size()) - 1);
  std::string points;
  std::string dots;
  for (size_t i = 0; i < steps.size(); ++i) {
    const double x = left + kPadding + step_width * static_cast<double>(i);
    const double y = kTop + kPadding +
                     (kPanelHeight - 2 * kPadding) *
                         (high->energy - steps[i].energy) / range;
    points += fmt::format("{:.1f},{:.1f} ", x, y);
    dots +=
        fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.5\"/>\n", x, y);
  }
  const double right = left + width;
  const double below = kTop + kPanelHeight + 16;
  return Element("rect", left, kTop,
                 fmt::format("width=\"{:.1f}\" height=\"{:.1f}\"", width,
                             kPanelHeight) +
                     " fill=\"#f4f4f4\"",
                 "") +
         "<polyline points=\"" + points +
         "\" fill=\"none\" stroke=\"#1f5fa8\" stroke-width=\"1.5\"/>\n" +
         "<g fill=\"#1f5fa8\">\n" + dots + "</g>\n" +
         Text(left, kTop - 8, "start", StageName(steps[0])) +
         Text(left, below, "start",
              fmt::format("{:.5g}", steps.front().energy)) +
         Text(right, below, "end", fmt::format("{:.5g}", steps.back().energy)) +
         Text(left + width / 2, below + 16, "middle",
              fmt::format("{} iterations",
                          steps.back().iteration - steps.front().iteration));
}

}  // namespace

std::string StepsPlot(const std::vector<RefinementStep>& steps) {
  double left = kMargin;
  std::string panels;
  for (const Steps& stage : SplitIntoStages(steps)) {
    panels += Panel(stage, left);
    left += PanelWidth(stage) + kMargin;
  }
  const double width = std::max(left, 2 * kMargin + kMinPanelWidth);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" " +
         fmt::format("width=\"{:.0f}\" height=\"{:.0f}\" ", width, kHeight) +
         fmt::format("viewBox=\"0 0 {:.0f} {:.0f}\" ", width, kHeight) +
         "font-family=\"sans-serif\" font-size=\"12\" fill=\"#333\">\n"
         "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n" +
         Text(kMargin, 28, "start", "Energy by iteration") + panels +
         "</svg>\n";
}

}  // namespace colmap_ext
