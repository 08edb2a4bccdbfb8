#include "colmap_ext/report/html_page.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "colmap_ext/report/html_text.h"
#include "colmap_ext/report/page_style.h"
#include "formats/encode_png.h"

namespace colmap_ext {

namespace {

// Rows; what has more gets a frame of its own to scroll in.
constexpr size_t kLongSection = 40;

std::string Trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first);
}

bool IsOfNumbers(const ReportRow& row) { return row.text.starts_with(' '); }

// Blanks that all columns of numbers start with.
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
      const auto row = std::find_if(
          section.rows.begin(), section.rows.end(),
          [&](const ReportRow& each) { return each.label == key.label; });
      if (section.heading == key.section && row != section.rows.end()) {
        items +=
            fmt::format("<li><b>{}</b>{}</li>\n",
                        EscapeHtml(Trimmed(row->text)), EscapeHtml(key.name));
      }
    }
  }
  return items.empty() ? "" : "<ul class=\"keys\">\n" + items + "</ul>\n";
}

std::string HtmlOptions(const std::vector<PageOption>& options) {
  std::string given;
  std::string others;
  for (const PageOption& option : options) {
    (option.is_default ? others : given) += fmt::format(
        "<tr><th scope=\"row\"><code>--{}</code></th><td><code>{}</code></td>"
        "</tr>\n",
        EscapeHtml(option.name), EscapeHtml(option.value));
  }
  const auto table = [](const std::string& rows) {
    return rows.empty() ? "" : "<table>\n" + rows + "</table>\n";
  };
  return "<h2>Options</h2>\n<div class=\"card\">\n" + table(given) +
         (others.empty() ? ""
                         : "<details>\n<summary>those that are as by "
                           "default</summary>\n" +
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

}  // namespace

std::vector<PageOption> PageOptions(const CommandOptions& options) {
  std::vector<PageOption> page_options;
  for (const CommandOptions::Option& option : options.Options()) {
    const std::string value = option.text();
    page_options.push_back({option.name, value, value == option.default_value});
  }
  return page_options;
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
         HtmlOptions(run.options) + "<p class=\"soft\">" +
         EscapeHtml(run.version) + "</p>\n</body>\n</html>\n";
}

}  // namespace colmap_ext
