#include "tests/report/well_formed.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

namespace colmap_ext {

namespace {

std::string EntityDefect(const std::string& text) {
  for (size_t at = text.find('&'); at != std::string::npos;
       at = text.find('&', at + 1)) {
    const std::string entity = text.substr(at, text.find(';', at) - at);
    if (entity != "&amp" && entity != "&lt" && entity != "&gt" &&
        entity != "&quot" && entity != "&#39") {
      return "entity " + text.substr(at, 20);
    }
  }
  return "";
}

// The place behind the end of the tag that starts at `start`.
size_t TagEnd(const std::string& document, size_t start) {
  char quote = 0;
  for (size_t i = start; i < document.size(); ++i) {
    const char c = document[i];
    if (quote != 0) {
      quote = c == quote ? 0 : quote;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return i + 1;
    }
  }
  return document.size();
}

bool AreAttributesGood(std::string_view text) {
  constexpr std::string_view kBlanks = " \n";
  for (;;) {
    const size_t start = text.find_first_not_of(kBlanks);
    if (start == 0 && text != "/") {
      return false;  // no blank before the attribute
    }
    if (start == std::string_view::npos || text.substr(start) == "/") {
      return true;
    }
    text.remove_prefix(start);
    const size_t equals = text.find("=\"");
    const auto is_of_name = [](char c) {
      return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '-';
    };
    if (equals == std::string_view::npos || equals == 0 ||
        !std::ranges::all_of(text.substr(0, equals), is_of_name)) {
      return false;
    }
    text.remove_prefix(equals + 2);
    const size_t end = text.find('"');
    if (end == std::string_view::npos || text.find('<') < end) {
      return false;
    }
    text.remove_prefix(end + 1);
  }
}

// \param tag  without its brackets.
std::string TagDefect(const std::string& tag, std::vector<std::string>* open) {
  if (tag[0] == '/') {
    if (open->empty() || open->back() != tag.substr(1)) {
      return "closes " + tag;
    }
    open->pop_back();
    return "";
  }
  const size_t name_end = tag.find_first_of(" \n/");
  const std::string name = tag.substr(0, name_end);
  const std::string rest =
      name_end == std::string::npos ? "" : tag.substr(name_end);
  if (!AreAttributesGood(rest)) {
    return "attributes of " + tag.substr(0, 80);
  }
  if (!rest.ends_with('/')) {
    open->push_back(name);
  }
  return "";
}

}  // namespace

std::string XmlDefect(const std::string& document) {
  std::vector<std::string> open;
  size_t at = document.starts_with("<!DOCTYPE html>\n") ? 16 : 0;
  std::string defect = EntityDefect(document);
  while (defect.empty()) {
    const size_t start = document.find('<', at);
    if (start == std::string::npos) {
      break;
    }
    at = TagEnd(document, start);
    defect = TagDefect(document.substr(start + 1, at - start - 2), &open);
  }
  return defect.empty() && !open.empty() ? "open: " + open.back() : defect;
}

}  // namespace colmap_ext
