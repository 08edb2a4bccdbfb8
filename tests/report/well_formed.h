#pragma once

#include <string>

namespace colmap_ext {

// What is wrong with a document as XML, apart from its declarations: elements
// are closed in their order, attributes are quoted, the five entities that need
// no declaration are the only ones. Empty where nothing is.
std::string XmlDefect(const std::string& document);

}  // namespace colmap_ext
