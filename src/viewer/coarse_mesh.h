#pragma once

#include <cstddef>

#include "viewer/shown_scene.h"

namespace colmap_ext {

// A mesh of about so many facets that stands for a larger one while it moves,
// where drawing is slow: vertices within a cube of a grid become one
// [Rossignac1993]. It is not manifold; labels and colours are kept.
// \pre max_facets > 0
ShownMesh CoarseMesh(const ShownMesh& mesh, size_t max_facets);

}  // namespace colmap_ext
