#pragma once

#include <string>

namespace colmap_ext {

// Reads an option that is one of two words.
// \return whether it is the second.
// \throw OptionError if it is neither.
bool IsSecondWord(const char* option, const std::string& word,
                  const char* first, const char* second);

// \throw OptionError unless it is positive, or -1 for all.
void CheckNumThreads(int num_threads);

}  // namespace colmap_ext
