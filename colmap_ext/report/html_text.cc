#include "colmap_ext/report/html_page.h"

#include <bit>
#include <cstddef>
#include <cstdint>

namespace colmap_ext {

namespace {

constexpr const char* kReplacement = "\xef\xbf\xbd";

// Whether the character is one of XML 1.0 (production 2).
bool IsCharacter(uint32_t code) {
  return code == '\t' || code == '\n' || code == '\r' ||
         (code >= 0x20 && code < 0xd800) || (code >= 0xe000 && code < 0xfffe) ||
         (code >= 0x10000 && code <= 0x10ffff);
}

// The number of bytes of the character that the text starts with (RFC 3629); 0
// if it starts with none.
size_t CharacterLength(std::string_view text) {
  const auto first = static_cast<uint8_t>(text[0]);
  const int ones = std::countl_one(first);
  const size_t length = ones == 0 ? 1 : ones;
  if (ones == 1 || ones > 4 || text.size() < length) {
    return 0;
  }
  uint32_t code = ones == 0 ? first : first & (0x7f >> ones);
  for (size_t i = 1; i < length; ++i) {
    const auto next = static_cast<uint8_t>(text[i]);
    if ((next & 0xc0) != 0x80) {
      return 0;
    }
    code = code << 6 | (next & 0x3f);
  }
  constexpr uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  return IsCharacter(code) && code >= kLeast[length] ? length : 0;
}

std::string_view EscapeCharacter(std::string_view character) {
  switch (character[0]) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return character;
  }
}

}  // namespace

std::string EscapeHtml(std::string_view text) {
  std::string escaped;
  while (!text.empty()) {
    const size_t length = CharacterLength(text);
    escaped +=
        length > 0 ? EscapeCharacter(text.substr(0, length)) : kReplacement;
    text.remove_prefix(length > 0 ? length : 1);
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

}  // namespace colmap_ext
