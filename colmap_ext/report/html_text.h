#pragma once

#include <string>
#include <string_view>

namespace colmap_ext {

// Text as it stands in HTML and XML, in elements and in quoted attributes. What
// is no UTF-8, or no character of XML, becomes U+FFFD: file names may be in any
// encoding.
std::string EscapeHtml(std::string_view text);

// Bytes by RFC 4648, section 4.
std::string Base64(std::string_view bytes);

}  // namespace colmap_ext
