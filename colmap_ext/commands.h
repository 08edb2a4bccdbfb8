// The commands that this extension adds to COLMAP's command line.
//
// This header is included by COLMAP's own main() (see patches/), which is
// compiled as C++14 by COLMAP 3.8: keep it free of newer C++ and of COLMAP.

#pragma once

#include <vector>

namespace colmap_ext {

struct Command {
  const char* name;
  // As COLMAP's commands: argv[0] is the program and argv[1] the first option.
  // Returns the exit status.
  int (*run)(int argc, char** argv);
  const char* help;  // a few words
};

// In alphabetical order.
const std::vector<Command>& Commands();

// Lets COLMAP's automatic reconstruction run them (dense_meshing.h).
void EnableDenseMeshing();

int RunDelaunayManifoldMesher(int argc, char** argv);
int RunFacetwiseRefiner(int argc, char** argv);
int RunMeshEvaluator(int argc, char** argv);
int RunMeshMerger(int argc, char** argv);
int RunMeshPlanner(int argc, char** argv);
int RunMeshViewer(int argc, char** argv);

}  // namespace colmap_ext
