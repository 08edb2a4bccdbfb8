#include "colmap_ext/report/run_pages.h"

#include "colmap_ext/report/refinement_report.h"

namespace colmap_ext {

namespace {

const KeyFigure kSeconds = {"Time", "all", "in all"};
const KeyFigure kMemory = {"Time", "peak memory", "peak memory"};

std::string Plot(const std::vector<RefinementStep>& steps, StepValue value) {
  return "<div class=\"card plot\">\n" + StepsFigure(steps, value) + "</div>\n";
}

}  // namespace

std::string RefinementPage(const PageRun& run, const ReportLog& log,
                           const std::vector<RefinementStep>& steps,
                           const PagePictures& pictures) {
  const std::string plots = steps.empty()
                                ? ""
                                : "<h2>Iterations</h2>\n" +
                                      Plot(steps, StepValue::kEnergy) +
                                      Plot(steps, StepValue::kMeanZncc);
  return HtmlPage(run, log,
                  {{"Mesh", "faces", "faces"},
                   {"Mesh", "vertices", "vertices"},
                   {"Workspace", "images", "images"},
                   kSeconds,
                   kMemory},
                  plots, pictures);
}

std::string MeshingPage(const PageRun& run, const ReportLog& log,
                        const PagePictures& pictures) {
  return HtmlPage(run, log,
                  {{"Workspace", "points read", "points"},
                   {"Cells", "vertices, after thinning", "after thinning"},
                   {"Cells", "cells", "cells"},
                   {"Mesh", "faces", "faces"},
                   kSeconds,
                   kMemory},
                  "", pictures);
}

}  // namespace colmap_ext
