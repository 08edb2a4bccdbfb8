#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/report/print_report.h"
#include "refine/facetwise_refinement.h"
#include "scene/images.h"

namespace colmap_ext {

// A page on a run of a command: one self-contained HTML file, without scripts,
// which is also well-formed XML.

// Returns the current options of a command.
std::vector<PageOption> PageOptions(const CommandOptions& options);

// The run that a page describes.
struct PageRun {
  std::string command;  // "facetwise_refiner"
  std::string output;   // the path of the mesh
  std::string version;  // of the program
};

// Pictures of one kind, from each of the cameras.
struct PictureRow {
  std::string title;
  std::string note;                  // how to read them; may be empty
  bool has_scale = false;            // of ErrorColor() from 0 to 1
  std::vector<ColorImage> pictures;  // [cameras], width 0 if there is none
};

struct PagePictures {
  std::vector<std::string> cameras;  // the names of their images
  std::vector<PictureRow> rows;
};

// The page of a refinement.
std::string RefinementPage(const PageRun& run, const ReportLog& log,
                           const std::vector<RefinementStep>& steps,
                           const PagePictures& pictures);

// The page of a meshing.
std::string MeshingPage(const PageRun& run, const ReportLog& log,
                        const PagePictures& pictures);

// Escapes text for elements and quoted attributes of HTML and XML. Bytes that
// are not UTF-8, or no character of XML, become U+FFFD: file names may be in
// any encoding.
std::string EscapeHtml(std::string_view text);

// Encodes bytes (RFC 4648, section 4).
std::string Base64(std::string_view bytes);

}  // namespace colmap_ext
