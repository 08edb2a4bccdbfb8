#include <string>

#include "colmap_ext/refinement/resume_file.h"
#include "formats/errors.h"

// What is read is written and read again as the same.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t num_bytes) {
  const std::string text(reinterpret_cast<const char*>(bytes), num_bytes);
  try {
    const std::string written =
        ResumeText(colmap_ext::ParseResumeText(text, "resume"));
    if (ResumeText(colmap_ext::ParseResumeText(written, "resume")) != written) {
      __builtin_trap();
    }
  } catch (const colmap_ext::FileError&) {
  }
  return 0;
}
