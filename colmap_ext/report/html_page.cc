#include "colmap_ext/report/html_page.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/picture_files.h"

namespace colmap_ext {
namespace {

// The style of all pages, for dark and light, narrow and wide windows.
constexpr const char* kPageStyle = R"(
:root { color-scheme: light dark; --page: #fbfbfa; --card: #ffffff;
  --line: #dcdcd8; --text: #20242a; --soft: #666d78; --panel: #f1f2f3;
  --curve: #1f5fa8; --warn: #fff3d6; --warn-line: #d9a400; }
@media (prefers-color-scheme: dark) {
  :root { --page: #16181c; --card: #1e2126; --line: #363b43; --text: #e4e6ea;
    --soft: #9aa2ae; --panel: #282c33; --curve: #7db3f0; --warn: #3a3011;
    --warn-line: #c79a1a; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 84rem; padding: 1.5rem;
  background: var(--page); color: var(--text);
  font: 15px/1.45 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { margin: 0; font-size: 1.6rem; }
h2 { margin: 2.2rem 0 0.7rem; font-size: 1.2rem; }
h3 { margin: 0 0 0.4rem; font-size: 1rem; }
p { margin: 0.2rem 0; }
.soft { color: var(--soft); overflow-wrap: anywhere; }
.keys { display: flex; flex-wrap: wrap; gap: 0.7rem; margin: 1.2rem 0 0;
  padding: 0; list-style: none; }
.keys li { flex: 1 1 9rem; padding: 0.6rem 0.9rem; background: var(--card);
  border: 1px solid var(--line); border-radius: 6px; }
.keys b { display: block; font-size: 1.25rem; font-weight: 600; }
.warnings { margin: 1.2rem 0 0; padding: 0.7rem 1rem 0.7rem 2rem;
  background: var(--warn); border: 1px solid var(--warn-line);
  border-radius: 6px; overflow-wrap: anywhere; }
.cards { columns: 2 34rem; column-gap: 1rem; }
.card { break-inside: avoid; margin: 0 0 1rem; padding: 0.8rem 1rem;
  background: var(--card); border: 1px solid var(--line); border-radius: 6px;
  overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 0.85rem; }
th, td { padding: 0.12rem 0; text-align: left; vertical-align: top;
  font-weight: normal; }
th { min-width: 5rem; padding-right: 1rem; color: var(--soft);
  overflow-wrap: anywhere; }
td { overflow-wrap: anywhere; }
th.inner { padding-left: 1rem; }
td.numbers { white-space: pre;
  font-family: ui-monospace, "DejaVu Sans Mono", monospace; }
.stages td, .stages th + th { padding: 0.12rem 0 0.12rem 1rem; text-align: right;
  font-variant-numeric: tabular-nums; }
tr.names td { color: var(--soft); }
tr + tr { border-top: 1px solid var(--panel); }
.long { max-height: 30rem; overflow-y: auto; }
.plot svg { max-width: 100%; min-width: 44rem; height: auto; }
.plot svg > rect:first-child { fill: none; }
.plot rect { fill: var(--panel); }
.plot text { fill: var(--text); }
.plot polyline { stroke: var(--curve); }
.plot g { fill: var(--curve); }
.pictures { display: grid; gap: 0.7rem; margin: 0 0 1.4rem; }
.pictures figure { margin: 0; }
.pictures img { display: block; width: 100%; height: auto;
  border: 1px solid var(--line); border-radius: 4px; }
.pictures figcaption { color: var(--soft); font-size: 0.8rem;
  overflow-wrap: anywhere; }
.pictures .none { padding: 3rem 0; text-align: center; color: var(--soft);
  border: 1px dashed var(--line); border-radius: 4px; }
@media (max-width: 40rem) {
  .pictures { grid-template-columns: 1fr !important; } }
.scale { display: inline-block; width: 10rem; height: 0.7rem; margin: 0 0.4rem;
  background: linear-gradient(to right, #440154, #482878, #3e4a7a, #31688e,
    #26828e, #1f9e89, #35b779, #6dcd59, #b4de2c, #fde725); }
summary { cursor: pointer; margin: 0.5rem 0; }
code { font-family: ui-monospace, "DejaVu Sans Mono", monospace; }
)";

// A row of a report that stands at the head of the page, if it exists.
struct KeyFigure {
  std::string section;
  std::string label;
  std::string name;  // on the page
};

// A section with more rows gets a frame to scroll in.
constexpr size_t kLongSection = 40;

std::string Trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first);
}

bool IsOfNumbers(const ReportRow& row) { return row.text.starts_with(' '); }

// The number of blanks that all columns of numbers start with.
size_t CommonIndent(const ReportSection& section) {
  size_t indent = std::string::npos;
  for (const ReportRow& row : section.rows) {
    if (IsOfNumbers(row)) {
      indent = std::min(indent, row.text.find_first_not_of(' '));
    }
  }
  return indent;
}

std::string HtmlRow(const ReportRow& row, size_t indent) {
  const std::string text =
      IsOfNumbers(row)
          ? "<td class=\"numbers\">" + EscapeHtml(row.text.substr(indent))
          : "<td>" + EscapeHtml(row.text);
  return fmt::format("<tr{}><th scope=\"row\"{}>{}</th>{}</td></tr>\n",
                     row.label.empty() ? " class=\"names\"" : "",
                     row.label.starts_with(' ') ? " class=\"inner\"" : "",
                     EscapeHtml(Trimmed(row.label)), text);
}

std::string HtmlSection(const ReportSection& section) {
  if (section.rows.empty()) {
    return "";
  }
  const size_t indent = CommonIndent(section);
  std::string rows;
  for (const ReportRow& row : section.rows) {
    rows += HtmlRow(row, indent);
  }
  return fmt::format(
      "<section class=\"card{}\">\n<h3>{}</h3>\n<table>\n{}</table>\n"
      "</section>\n",
      section.rows.size() > kLongSection ? " long" : "",
      EscapeHtml(section.heading), rows);
}

std::string HtmlSections(const std::vector<ReportSection>& sections) {
  std::string html = "<h2>Figures</h2>\n<div class=\"cards\">\n";
  for (const ReportSection& section : sections) {
    html += HtmlSection(section);
  }
  return html + "</div>\n";
}

std::string HtmlWarnings(const std::vector<std::string>& warnings) {
  if (warnings.empty()) {
    return "";
  }
  std::string html = "<ul class=\"warnings\">\n";
  for (const std::string& warning : warnings) {
    html += "<li>" + EscapeHtml(warning) + "</li>\n";
  }
  return html + "</ul>\n";
}

std::string HtmlKeyFigures(const std::vector<KeyFigure>& key_figures,
                           const ReportLog& log) {
  std::string items;
  for (const KeyFigure& key : key_figures) {
    for (const ReportSection& section : log.sections) {
      const auto row =
          std::ranges::find(section.rows, key.label, &ReportRow::label);
      if (section.heading == key.section && row != section.rows.end()) {
        items +=
            fmt::format("<li><b>{}</b>{}</li>\n",
                        EscapeHtml(Trimmed(row->text)), EscapeHtml(key.name));
      }
    }
  }
  return items.empty() ? "" : "<ul class=\"keys\">\n" + items + "</ul>\n";
}

std::string HtmlOptions(const CommandOptions& command) {
  std::string given;
  std::string others;
  for (const CommandOptions::Option& option : command.Options()) {
    const std::string value = option.text();
    (value == option.default_value ? others : given) += fmt::format(
        "<tr><th scope=\"row\"><code>--{}</code></th><td><code>{}</code></td>"
        "</tr>\n",
        EscapeHtml(option.name), EscapeHtml(value));
  }
  const auto table = [](const std::string& rows) {
    return rows.empty() ? "" : "<table>\n" + rows + "</table>\n";
  };
  return "<h2>Options</h2>\n<div class=\"card\">\n" + table(given) +
         (others.empty() ? ""
                         : "<details>\n<summary>defaults</summary>\n" +
                               table(others) + "</details>\n") +
         "</div>\n";
}

std::string HtmlPicture(const ColorImage& image, const std::string& title,
                        const std::string& camera) {
  const std::string name = EscapeHtml(camera);
  if (image.width == 0) {
    return "<figure>\n<div class=\"none\">there is none</div>\n<figcaption>" +
           name + "</figcaption>\n</figure>\n";
  }
  return fmt::format(
      "<figure>\n<img width=\"{}\" height=\"{}\" alt=\"{}, {}\" "
      "src=\"data:image/png;base64,{}\"/>\n<figcaption>{}</figcaption>\n"
      "</figure>\n",
      image.width, image.height, EscapeHtml(title), name,
      Base64(EncodePng(image)), name);
}

std::string HtmlPictureRow(const PictureRow& row,
                           const std::vector<std::string>& cameras) {
  std::string figures;
  for (size_t i = 0; i < row.pictures.size(); ++i) {
    figures += HtmlPicture(row.pictures[i], row.title, cameras[i]);
  }
  std::string note = EscapeHtml(row.note);
  if (row.has_scale) {
    note += " 0<span class=\"scale\"></span>1";
  }
  return "<h3>" + EscapeHtml(row.title) + "</h3>\n" +
         (note.empty() ? "" : "<p class=\"soft\">" + note + "</p>\n") +
         fmt::format(
             "<div class=\"pictures\" style=\"grid-template-columns: "
             "repeat({}, minmax(0, 30rem))\">\n",
             row.pictures.size()) +
         figures + "</div>\n";
}

std::string HtmlPictures(const PagePictures& pictures) {
  if (pictures.cameras.empty()) {
    return "";
  }
  std::string html = "<h2>Pictures</h2>\n";
  for (const PictureRow& row : pictures.rows) {
    html += HtmlPictureRow(row, pictures.cameras);
  }
  return html;
}

std::string HtmlPage(const PageRun& run, const ReportLog& log,
                     const std::vector<KeyFigure>& key_figures,
                     const std::string& plots, const PagePictures& pictures) {
  const std::string command = EscapeHtml(run.command);
  const std::string output = EscapeHtml(run.output);
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
         "<meta charset=\"utf-8\"/>\n"
         "<meta name=\"viewport\" content=\"width=device-width\"/>\n<title>" +
         command + ": " + output + "</title>\n<style>" + kPageStyle +
         "</style>\n</head>\n<body>\n<h1>" + command +
         "</h1>\n<p class=\"soft\">" + output + "</p>\n" +
         HtmlKeyFigures(key_figures, log) + HtmlWarnings(log.warnings) + plots +
         HtmlPictures(pictures) + HtmlSections(log.sections) +
         (log.command != nullptr ? HtmlOptions(*log.command) : "") +
         "<p class=\"soft\">" + EscapeHtml(run.version) +
         "</p>\n</body>\n</html>\n";
}

const KeyFigure kSeconds = {"Time", "all", "in all"};
const KeyFigure kMemory = {"Time", "peak memory", "peak memory"};

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

std::string EscapeHtml(std::string_view text) {
  // The last one replaces what is no character of XML.
  constexpr std::string_view kSpecial = "&<>\"'";
  constexpr const char* kEscaped[] = {"&amp;",  "&lt;",  "&gt;",
                                      "&quot;", "&#39;", "\xef\xbf\xbd"};
  const std::string valid = nlohmann::json::parse(nlohmann::json(text).dump(
      -1, ' ', false, nlohmann::json::error_handler_t::replace));
  std::string escaped;
  size_t end = 0;  // of the last character of U+FFFE and U+FFFF
  for (size_t i = 0; i < valid.size(); ++i) {
    const char c = valid[i];
    end = "\xef\xbf\xbe" <= valid.substr(i, 3) && c == '\xef' ? i + 3 : end;
    const bool is_control =
        static_cast<uint8_t>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r';
    const size_t place = kSpecial.find(c);
    escaped += is_control || i < end     ? kEscaped[kSpecial.size()]
               : place < kSpecial.size() ? kEscaped[place]
                                         : std::string(1, c);
  }
  return escaped;
}

std::string Base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t j = i; j < i + 3; ++j) {
      group =
          group << 8 | (j < bytes.size() ? static_cast<uint8_t>(bytes[j]) : 0);
    }
    for (size_t j = 0; j < 4; ++j) {
      text += i + j <= bytes.size() ? kDigits[group >> (18 - 6 * j) & 63] : '=';
    }
  }
  return text;
}

std::string RefinementPage(const PageRun& run, const ReportLog& log,
                           const std::vector<RefinementStep>& steps,
                           const PagePictures& pictures) {
  const std::string iterations =
      steps.empty()
          ? ""
          : "<h2>Iterations</h2>\n" + StagesTable(steps) +
                "<div class=\"card plot\">\n" + StepsFigure(steps) + "</div>\n";
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
