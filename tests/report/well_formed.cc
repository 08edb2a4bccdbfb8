#include "tests/report/well_formed.h"

#include <regex>
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

// The attributes one by one: a regular expression of them all would need a deep
// stack for long ones.
bool AreAttributesGood(std::string text) {
  static const std::regex kName("^\\s+[a-zA-Z-]+=\"");
  std::smatch match;
  while (std::regex_search(text, match, kName)) {
    const size_t end = text.find('"', match.length());
    if (end == std::string::npos || text.find('<', match.length()) < end) {
      return false;
    }
    text = text.substr(end + 1);
  }
  return text.empty() || text == "/";
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
