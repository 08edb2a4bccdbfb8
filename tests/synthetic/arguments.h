#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace colmap_ext::synthetic {

// The options of a program by name, `--name value`, each bound to a variable,
// whose value so far is the default.
class Arguments {
 public:
  template <typename T>
  void Add(const std::string& name, T* value, const std::string& help) {
    const std::string usual = Format(*value);
    std::string column = "  --" + name + " ";
    column.resize(std::max<size_t>(column.size(), 27), ' ');
    help_ += column + help + (usual.empty() ? "" : " [" + usual + "]") + "\n";
    setters_["--" + name] = [value](const std::string& text) {
      return Parse(text, value);
    };
  }

  // \throw std::invalid_argument for unknown options and unreadable values.
  void Read(int argc, char** argv) const {
    for (int i = 1; i < argc; i += 2) {
      const auto setter = setters_.find(argv[i]);
      if (setter == setters_.end()) {
        throw std::invalid_argument(std::string("unknown option ") + argv[i]);
      }
      if (i + 1 == argc || !setter->second(argv[i + 1])) {
        throw std::invalid_argument(std::string(argv[i]) +
                                    " lacks a proper value");
      }
    }
  }

  const std::string& Help() const { return help_; }

  static bool AsksForHelp(int argc, char** argv) {
    const std::string first = argc > 1 ? argv[1] : "-h";
    return first == "-h" || first == "--help" || first == "help";
  }

 private:
  template <typename T>
  static std::string Format(const T& value) {
    std::ostringstream stream;
    stream << value;
    return stream.str();
  }
  static std::string Format(const std::vector<double>&) { return ""; }

  template <typename T>
  static bool Parse(const std::string& text, T* value) {
    std::istringstream stream(text);
    return stream >> *value && (stream >> std::ws).eof();
  }
  static bool Parse(const std::string& text, std::string* value) {
    *value = text;
    return true;
  }
  // Numbers with commas between.
  static bool Parse(const std::string& text, std::vector<double>* value) {
    std::istringstream stream(text);
    value->clear();
    for (std::string part; std::getline(stream, part, ',');) {
      if (!Parse(part, &value->emplace_back())) {
        return false;
      }
    }
    return !value->empty();
  }

  std::map<std::string, std::function<bool(const std::string&)>> setters_;
  std::string help_;
};

}  // namespace colmap_ext::synthetic
