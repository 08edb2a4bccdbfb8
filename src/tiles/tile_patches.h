#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// A surface that jobs change piece by piece. Its base is a mesh in blocks; the
// job of a tile leaves a patch, which removes facets of the base and of patches
// before it, and adds others. Vertices and facets have identities that all jobs
// share.

// A vertex, or a facet, of the base or of a patch.
using SurfaceId = uint64_t;

inline SurfaceId BaseId(uint64_t index) { return index; }
inline SurfaceId PatchId(uint32_t tile, uint64_t index) {
  return (uint64_t{tile} + 1) << 40 | index;
}

// A part of the surface.
struct SurfacePart {
  TriangleMesh mesh;
  VertexAttributes attributes;       // [V]
  std::vector<SurfaceId> ids;        // [V]
  std::vector<SurfaceId> facet_ids;  // [F]
};

struct TilePatch {
  Eigen::AlignedBox3f box;         // of all that is removed and added
  std::vector<SurfaceId> removed;  // facets, ascending
  // What is added; vertices that were there before have their identities.
  SurfacePart part;
};

class SurfaceStore {
 public:
  virtual ~SurfaceStore() = default;

  virtual size_t NumBlocks() const = 0;
  virtual Eigen::AlignedBox3f BlockBox(size_t block) const = 0;
  virtual SurfacePart ReadBlock(size_t block) const = 0;

  virtual Eigen::AlignedBox3f PatchBox(uint32_t tile) const = 0;
  virtual std::vector<SurfaceId> ReadRemoved(uint32_t tile) const = 0;
  virtual SurfacePart ReadPatchPart(uint32_t tile) const = 0;
};

// Patches do not fit each other.
class PatchError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

using AcceptBox = std::function<bool(const Eigen::AlignedBox3f& box)>;

// The facets of a surface whose boxes are accepted: the base's first, then the
// patches' in their order; vertices in the order in which facets use them.
// \param patches  the tiles whose patches count
// \param accept  of a box that has an accepted one in it, too
// \throw PatchError if a facet is removed twice
SurfacePart GatherSurface(const SurfaceStore& store,
                          const std::vector<uint32_t>& patches,
                          const AcceptBox& accept);

// What a job's work makes of a part, as the patch of a tile. Facets all of
// whose corners are fixed are not removed.
// \param fixed  of the part before
// \param after  the part's mesh after the work
// \param attributes  of its vertices
// \param sources [V after] the vertex before, where it is fixed, or kNone;
//        empty: none is
// \throw std::logic_error if a facet between fixed vertices is gone
TilePatch MakePatch(uint32_t tile, const SurfacePart& before,
                    const FixedVertices& fixed, const TriangleMesh& after,
                    const VertexAttributes& attributes,
                    const std::vector<uint32_t>& sources);

}  // namespace colmap_ext
