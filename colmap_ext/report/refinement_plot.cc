#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/report/print_report.h"

namespace colmap_ext {

namespace {

using Steps = std::vector<RefinementStep>;

// All sizes in px.
constexpr double kStepWidth = 24;
constexpr double kMinPanelWidth = 190;
constexpr double kPanelHeight = 200;
constexpr double kMargin = 24;   // around everything, and between panels
constexpr double kPadding = 14;  // of a curve in its panel
constexpr double kTop = 64;      // of the panels
constexpr double kHeight = kTop + kPanelHeight + 48;

// The plotted value.
struct Curve {
  const char* name;
  double (*of)(const RefinementStep& step);
  std::string (*text)(double value);
};

Curve CurveOf(StepValue value) {
  if (value == StepValue::kEnergy) {
    return {"Energy", [](const RefinementStep& step) { return step.energy; },
            [](double energy) { return fmt::format("{:.6g}", energy); }};
  }
  return {"Mean ZNCC",
          [](const RefinementStep& step) { return step.mean_zncc; },
          [](double zncc) { return fmt::format("{:.4f}", zncc); }};
}

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
std::string Panel(const Steps& steps, const Curve& curve, double left) {
  const auto [low, high] = std::minmax_element(
      steps.begin(), steps.end(), [&curve](const auto& a, const auto& b) {
        return curve.of(a) < curve.of(b);
      });
  const double highest = curve.of(*high);
  const double range = std::max(highest - curve.of(*low), 1e-300);
  const double width = PanelWidth(steps);
  const double step_width =
      (width - 2 * kPadding) /
      std::max(1.0, static_cast<double>(steps.size()) - 1);
  std::string points;
  std::string dots;
  for (size_t i = 0; i < steps.size(); ++i) {
    const double x = left + kPadding + step_width * static_cast<double>(i);
    const double y =
        kTop + kPadding +
        (kPanelHeight - 2 * kPadding) * (highest - curve.of(steps[i])) / range;
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
         Text(left, below, "start", curve.text(curve.of(steps.front()))) +
         Text(right, below, "end", curve.text(curve.of(steps.back()))) +
         Text(left + width / 2, below + 16, "middle",
              fmt::format("{} iterations",
                          steps.back().iteration - steps.front().iteration));
}

// \param attributes  of the element, in addition to its size.
std::string Plot(const Steps& steps, const Curve& curve,
                 const std::string& attributes) {
  double left = kMargin;
  std::string panels;
  for (const Steps& stage : SplitIntoStages(steps)) {
    panels += Panel(stage, curve, left);
    left += PanelWidth(stage) + kMargin;
  }
  const double width = std::max(left, 2 * kMargin + kMinPanelWidth);
  return "<svg " + attributes +
         fmt::format("width=\"{:.0f}\" height=\"{:.0f}\" ", width, kHeight) +
         fmt::format("viewBox=\"0 0 {:.0f} {:.0f}\" ", width, kHeight) +
         "font-family=\"sans-serif\" font-size=\"12\" fill=\"#333\">\n"
         "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n" +
         Text(kMargin, 28, "start", curve.name + std::string(" by iteration")) +
         panels + "</svg>\n";
}

}  // namespace

std::string StepsFigure(const std::vector<RefinementStep>& steps,
                        StepValue value) {
  return Plot(steps, CurveOf(value), "role=\"img\" ");
}

std::string StepsPlot(const std::vector<RefinementStep>& steps) {
  return Plot(steps, CurveOf(StepValue::kEnergy),
              "xmlns=\"http://www.w3.org/2000/svg\" ");
}

}  // namespace colmap_ext
