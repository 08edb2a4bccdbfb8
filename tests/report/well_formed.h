#pragma once

#include <stdlib.h>

#include <string>

#include "tests/formats/test_files.h"

namespace colmap_ext {

// What Python's parser of XML says against a document; empty if it is
// well-formed.
inline std::string XmlDefect(const std::string& document) {
  const TemporaryFolder folder;
  const std::string path = (folder.Path() / "document").string();
  WriteFile(path, document);
  const std::string command =
      "\"" COLMAP_EXT_PYTHON
      "\" -c 'import sys, xml.sax; xml.sax.parse(sys.argv[1], "
      "xml.sax.ContentHandler())' " +
      path + " 2>" + path + ".err";
  return std::system(command.c_str()) == 0 ? "" : ReadFile(path + ".err");
}

}  // namespace colmap_ext
