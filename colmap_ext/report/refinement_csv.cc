#include <cstdio>
#include <string>
#include <vector>

#include "colmap_ext/report/refinement_report.h"

namespace colmap_ext {

std::string StepsCsv(const std::vector<RefinementStep>& steps) {
  std::string csv =
      "level,final,iteration,energy,photometric_energy,mean_zncc,mean_step_px,"
      "seconds,vertices,faces\n";
  for (const RefinementStep& step : steps) {
    char row[256];
    std::snprintf(row, sizeof(row),
                  "%d,%d,%d,%.9g,%.9g,%.6g,%.6g,%.3f,%zu,%zu\n", step.level,
                  step.is_final ? 1 : 0, step.iteration, step.energy,
                  step.photometric_energy, step.mean_zncc, step.mean_step,
                  step.seconds, step.num_vertices, step.num_facets);
    csv += row;
  }
  return csv;
}

}  // namespace colmap_ext
