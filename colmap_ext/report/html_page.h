#pragma once

#include <string>
#include <vector>

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/report/print_lines.h"
#include "scene/color_image.h"

namespace colmap_ext {

// A page on a run of a command: one HTML file with all that it shows, which can
// also be read as XML. Whoever reads it needs no network and no scripts.

struct PageOption {
  std::string name;   // without dashes
  std::string value;  // as it is typed
  bool is_default = true;
};

// \return the options of a command as they are now.
std::vector<PageOption> PageOptions(const CommandOptions& options);

// What every page says of its run.
struct PageRun {
  std::string command;  // "facetwise_refiner"
  std::string output;   // the path of the mesh
  std::string version;  // of the program
  std::vector<PageOption> options;
};

// Pictures of one kind, from each of the cameras.
struct PictureRow {
  std::string title;
  std::string note;                  // how to read them; may be empty
  bool has_scale = false;            // of ErrorColor() from 0 to 1
  std::vector<ColorImage> pictures;  // [cameras], of no width where there is
                                     // none
};

struct PagePictures {
  std::vector<std::string> cameras;  // the names of their images
  std::vector<PictureRow> rows;
};

// A row of a report that stands at the head of the page, where there is such.
struct KeyFigure {
  std::string section;
  std::string label;
  std::string name;  // there
};

// The page.
// \param plots  HTML of its own; may be empty.
std::string HtmlPage(const PageRun& run, const ReportLog& log,
                     const std::vector<KeyFigure>& key_figures,
                     const std::string& plots, const PagePictures& pictures);

}  // namespace colmap_ext
