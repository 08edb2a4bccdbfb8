#pragma once

#include <stdexcept>
#include <string>

namespace colmap_ext {

// A command line that asks for something impossible. The message is one line
// for the user.
class OptionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// \throw OptionError if the condition holds
inline void RefuseIf(bool condition, const char* message) {
  if (condition) {
    throw OptionError(message);
  }
}

// A signal that ended the work before it was done.
class Interruption : public std::runtime_error {
 public:
  Interruption(int signal, const std::string& message)
      : std::runtime_error(message), signal_(signal) {}

  int Signal() const { return signal_; }

 private:
  int signal_;
};

}  // namespace colmap_ext
