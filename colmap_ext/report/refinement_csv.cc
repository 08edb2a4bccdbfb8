#include <string>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/report/refinement_report.h"

namespace colmap_ext {

std::string StepsCsv(const std::vector<RefinementStep>& steps) {
  std::string csv =
      "level,final,iteration,energy,photometric_energy,mean_zncc,mean_step_px,"
      "seconds,vertices,faces,pairs\n";
  for (const RefinementStep& step : steps) {
    csv += fmt::format(
        "{},{:d},{},{:.9g},{:.9g},{:.6g},{:.6g},{:.3f},{},{},{}\n", step.level,
        step.is_final, step.iteration, step.energy, step.photometric_energy,
        step.mean_zncc, step.mean_step, step.seconds, step.num_vertices,
        step.num_facets, step.num_pairs);
  }
  return csv;
}

}  // namespace colmap_ext
