#pragma once

#include <string>
#include <vector>

#include "colmap_ext/report/html_page.h"
#include "colmap_ext/report/print_lines.h"
#include "refine/facetwise_refinement.h"

namespace colmap_ext {

// The page on a refinement.
std::string RefinementPage(const PageRun& run, const ReportLog& log,
                           const std::vector<RefinementStep>& steps,
                           const PagePictures& pictures);

// The page on a meshing.
std::string MeshingPage(const PageRun& run, const ReportLog& log,
                        const PagePictures& pictures);

}  // namespace colmap_ext
