// The stand-alone program: the same commands for an unpatched COLMAP.

#include <cstdlib>
#include <exception>
#include <iomanip>
#include <iostream>
#include <string>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/commands.h"
#include "colmap_ext/terminal/terminal.h"

namespace {

int ShowHelp() {
  std::cout << colmap_ext::Versions()
            << "\nSurface reconstruction commands for COLMAP\n\n"
               "Usage:\n"
               "  colmap_ext [command] [options]\n\n"
               "Example usage:\n"
               "  colmap_ext help [ -h, --help ]\n"
               "  colmap_ext delaunay_manifold_mesher -h [ --help ]\n"
               "  colmap_ext delaunay_manifold_mesher --workspace_path "
               "WORKSPACE\n"
               "  ...\n\n"
               "Available commands:\n"
               "  help\n";
  for (const colmap_ext::Command& command : colmap_ext::Commands()) {
    std::cout << "  " << std::left << std::setw(26) << command.name
              << command.help << "\n";
  }
  std::cout << std::endl;
  return EXIT_SUCCESS;
}

int RunCommand(const std::string& name, int argc, char** argv) {
  for (const colmap_ext::Command& command : colmap_ext::Commands()) {
    if (name == command.name) {
      argv[1] = argv[0];
      return command.run(argc - 1, argv + 1);
    }
  }
  std::cerr << "ERROR: Command `" << name
            << "` not recognized. To list the available commands, run "
               "`colmap_ext help`."
            << std::endl;
  return EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    colmap_ext::ProgramName() = "colmap_ext";
    const std::string name = argc < 2 ? "help" : argv[1];
    if (name == "help" || name == "-h" || name == "--help") {
      return ShowHelp();
    }
    if (name == "--version") {
      std::cout << colmap_ext::Versions() << std::endl;
      return EXIT_SUCCESS;
    }
    colmap_ext::InitializeLogging(argv);
    return RunCommand(name, argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "ERROR: " << error.what() << std::endl;
    return EXIT_FAILURE;
  }
}
