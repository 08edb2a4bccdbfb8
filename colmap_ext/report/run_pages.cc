#include "colmap_ext/report/run_pages.h"

#include "colmap_ext/report/refinement_report.h"

namespace colmap_ext {

namespace {

const KeyFigure kSeconds = {"Time", "all", "in all"};
const KeyFigure kMemory = {"Time", "peak memory", "peak memory"};

std::string Plot(const std::vector<RefinementStep>& steps, StepValue value) {
  return "<div class=\"card plot\">\n" + StepsFigure(steps, value) + "</div>\n";
}

std::string StagesTable(const std::vector<RefinementStep>& steps) {
  std::string rows;
  for (const StageText& stage : DescribeStages(steps)) {
    rows += "<tr><th scope=\"row\">" + stage.name + "</th>";
    for (const std::string& text :
         {stage.iterations, stage.faces, stage.energy[0], stage.energy[1],
          stage.mean_zncc[0], stage.mean_zncc[1]}) {
      rows += "<td>" + text + "</td>";
    }
    rows += "</tr>\n";
  }
  return "<div class=\"card\">\n<table class=\"stages\">\n"
         "<tr><th>stage</th><th>iterations</th><th>faces</th>"
         "<th>energy before</th><th>after</th><th>mean ZNCC before</th>"
         "<th>after</th></tr>\n" +
         rows + "</table>\n</div>\n";
}

}  // namespace

std::string RefinementPage(const PageRun& run, const ReportLog& log,
                           const std::vector<RefinementStep>& steps,
                           const PagePictures& pictures) {
  const std::string iterations =
      steps.empty() ? ""
                    : "<h2>Iterations</h2>\n" + StagesTable(steps) +
                          Plot(steps, StepValue::kEnergy) +
                          Plot(steps, StepValue::kMeanZncc);
  return HtmlPage(run, log,
                  {{"Mesh", "faces", "faces"},
                   {"Mesh", "vertices", "vertices"},
                   {"Workspace", "images", "images"},
                   kSeconds,
                   kMemory},
                  iterations, pictures);
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
