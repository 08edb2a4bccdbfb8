#include "tiles/tile_cut.h"

#include <cmath>
#include <memory>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "base/indices.h"
#include "base/lru_cache.h"
#include "delaunay/growing_complex.h"
#include "spatial/facet_tree.h"
#include "spatial/predicates.h"

namespace colmap_ext {
namespace {

// The centre of the sphere through o, a, b, c relative to o (docs/method.md,
// section 2.2).
Eigen::Vector3d CenterOfSphere(const Eigen::Vector3f& o,
                               const Eigen::Vector3f& pa,
                               const Eigen::Vector3f& pb,
                               const Eigen::Vector3f& pc) {
  // The volume over the product of the edges' lengths. The centre of a flatter
  // cell is far off in double precision.
  constexpr double kMinFlatness = 1e-5;
  const Eigen::Vector3d a = pa.cast<double>() - o.cast<double>();
  const Eigen::Vector3d b = pb.cast<double>() - o.cast<double>();
  const Eigen::Vector3d c = pc.cast<double>() - o.cast<double>();
  const Eigen::Vector3d bc = b.cross(c);
  const double volume = a.dot(bc);
  if (!(std::abs(volume) > kMinFlatness * a.norm() * b.norm() * c.norm())) {
    return CenterFrom(o, pa, pb, pc);
  }
  return (a.squaredNorm() * bc + b.squaredNorm() * c.cross(a) +
          c.squaredNorm() * a.cross(b)) /
         (2 * volume);
}

// Relative to distances from the centre, many times what rounding can do.
constexpr double kRelativeSlack = 1e-8;

// Where a point would be in conflict with a cell: the sphere around a finite
// cell, the half-space beyond an infinite one. A little larger, so that no
// rounding leaves out what is in conflict by exact predicates.
class ConflictZone {
 public:
  ConflictZone(const GrowingComplex& complex, uint32_t index) {
    const GrowingComplex::Cell& cell = complex.cells[index];
    const uint32_t infinite = InfiniteCorner(cell);
    const auto corner = [&](uint32_t i) -> const Eigen::Vector3f& {
      return complex.points[cell.vertices[i % 4]];
    };
    is_sphere_ = infinite == 4;
    if (is_sphere_) {
      const Eigen::Vector3d offset =
          CenterOfSphere(corner(0), corner(1), corner(2), corner(3));
      center_ = corner(0).cast<double>() + offset;
      const double radius = offset.norm();
      reach_ =
          radius + kRelativeSlack * (radius + corner(0).cast<double>().norm());
      return;
    }
    // The infinite vertex lies on the positive side of the facet.
    const auto at = [&](uint32_t i) -> Eigen::Vector3d {
      return corner(infinite + i).cast<double>();
    };
    center_ = at(1);
    const Eigen::Vector3d a = at(2) - at(1);
    const Eigen::Vector3d b = at(3) - at(1);
    normal_ = infinite % 2 == 0 ? b.cross(a) : a.cross(b);
    // That of a facet with hardly an area is not known well.
    constexpr double kMinSine = 1e-6;
    has_normal_ = normal_.norm() > kMinSine * a.norm() * b.norm();
    normal_.normalize();
    slack_ = kRelativeSlack * center_.norm();
  }

  // Whether the zone may reach into a box.
  bool MayTouch(const Eigen::AlignedBox3f& box) const {
    const auto wide = box.cast<double>();
    if (is_sphere_) {
      return wide.squaredExteriorDistance(center_) <= reach_ * reach_;
    }
    if (!has_normal_) {
      return true;
    }
    const Eigen::Vector3d farthest =
        (normal_.array() > 0).select(wide.max(), wide.min());
    return normal_.dot(farthest - center_) >=
           -slack_ - kRelativeSlack * (farthest - center_).norm();
  }

  // How deep a point lies within, in the zone's own measure: the deepest one of
  // several makes the smallest zones when it is inserted. Negative: outside.
  double Depth(const Eigen::Vector3f& point) const {
    const Eigen::Vector3d offset = point.cast<double>() - center_;
    if (is_sphere_) {
      return reach_ - offset.norm();
    }
    if (!has_normal_) {
      return 0;
    }
    return normal_.dot(offset) + slack_ + kRelativeSlack * offset.norm();
  }

 private:
  bool is_sphere_ = false;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();  // of the sphere, or a
                                                      // corner of the facet
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();  // unit, of a half-space
  bool has_normal_ = false;  // else nothing is known of where the zone is
  double reach_ = 0;         // of a sphere, from its centre, scene units
  double slack_ = 0;         // of distances from a half-space, scene units
};

// Vertices of a block whose box is known.
constexpr uint32_t kGroupVertices = 32;

// The vertices of a block.
struct BlockVertices {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::AlignedBox3f> boxes;  // of each kGroupVertices of them
};

// A number in [0, 1) that is always the same one for a block.
double ChanceOf(uint32_t block) {
  return static_cast<double>(MixBits((block + 1) * kSplitMixStep) >> 11) *
         0x1p-53;
}

// How many vertices of another tile's block are there from the start: all of
// them within its own size of the tile, and ever fewer, by the square of the
// distance, so that each ring of blocks around the tile has as many.
uint32_t NumFirst(uint32_t num_vertices, uint32_t block,
                  const Eigen::AlignedBox3f& box,
                  const Eigen::AlignedBox3f& own_box) {
  // At one block's size. A choice: some hundred vertices a ring.
  constexpr double kVertices = 64;
  const double size_squared = box.diagonal().squaredNorm();
  const double distance_squared = own_box.squaredExteriorDistance(box);
  if (distance_squared <= size_squared) {
    return num_vertices;
  }
  const double wanted =
      kVertices * size_squared / distance_squared + ChanceOf(block);
  return std::min(num_vertices, static_cast<uint32_t>(wanted));
}

class Certifier {
 public:
  Certifier(const PlanVertices& plan, uint32_t tile)
      : plan_(plan),
        blocks_(plan.Blocks()),
        tree_(blocks_.boxes),
        is_loaded_(blocks_.NumBlocks()),
        num_loaded_(blocks_.NumBlocks(), 0) {
    const uint32_t first = blocks_.FirstVertex(tile);
    num_own_ = blocks_.FirstVertex(tile + 1) - first;
    ids_ = Iota(num_own_, first);
    complex_.points = plan.ReadPositions(first, first + num_own_);
    for (uint32_t block = blocks_.tile_begins[tile];
         block < blocks_.tile_begins[tile + 1]; ++block) {
      is_loaded_[block].assign(SizeOf(block), 1);
      num_loaded_[block] = SizeOf(block);
      own_box_.extend(blocks_.boxes[block]);
    }
    AddFirstVertices();
    if (!SpansVolume(complex_.points)) {
      AddAllVertices();
    }
  }

  TileTetrahedra Run(const Progress& progress) {
    InsertPoints(InsertionOrder(complex_.points.size()), progress, &complex_);
    size_t num_rounds = 0;
    for (uint32_t first_new = 0; first_new < complex_.points.size();
         ++num_rounds) {
      const std::vector<uint32_t> missing = FindMissing(first_new);
      first_new = static_cast<uint32_t>(complex_.points.size());
      Insert(missing);
    }
    return Finish(num_rounds);
  }

 private:
  uint32_t SizeOf(uint32_t block) const {
    return blocks_.begins[block + 1] - blocks_.begins[block];
  }

  // Keeps the blocks that were read last. Safe from several threads.
  std::shared_ptr<BlockVertices> ReadBlock(uint32_t block) {
    // With a box for each group.
    constexpr size_t kVertexBytes =
        sizeof(Eigen::Vector3f) + sizeof(Eigen::AlignedBox3f) / kGroupVertices +
        1;
    return cache_.Get(block, SizeOf(block) * kVertexBytes, [&] {
      auto read = std::make_shared<BlockVertices>();
      read->positions =
          plan_.ReadPositions(blocks_.begins[block], blocks_.begins[block + 1]);
      for (size_t i = 0; i < read->positions.size(); ++i) {
        if (i % kGroupVertices == 0) {
          read->boxes.emplace_back();
        }
        read->boxes.back().extend(read->positions[i]);
      }
      return read;
    });
  }

  void AddFirstVertices() {
    for (uint32_t block = 0; block < blocks_.NumBlocks(); ++block) {
      if (!is_loaded_[block].empty()) {
        continue;
      }
      const uint32_t size = SizeOf(block);
      const uint32_t count =
          NumFirst(size, block, blocks_.boxes[block], own_box_);
      for (uint32_t i = 0; i < count; ++i) {
        complex_.points.push_back(
            Load(block, static_cast<uint32_t>(uint64_t{i} * size / count)));
      }
    }
  }

  // If the first vertices lie in a plane.
  void AddAllVertices() {
    for (uint32_t block = 0; block < blocks_.NumBlocks(); ++block) {
      for (uint32_t i = 0; i < SizeOf(block); ++i) {
        if (is_loaded_[block].empty() || is_loaded_[block][i] == 0) {
          complex_.points.push_back(Load(block, i));
        }
      }
    }
  }

  // \param place  of a vertex in the block
  // \return its position
  Eigen::Vector3f Load(uint32_t block, uint32_t place) {
    if (is_loaded_[block].empty()) {
      is_loaded_[block].assign(SizeOf(block), 0);
    }
    is_loaded_[block][place] = 1;
    ++num_loaded_[block];
    ids_.push_back(blocks_.begins[block] + place);
    return ReadBlock(block)->positions[place];
  }

  bool HasOwnVertex(uint32_t cell) const {
    return std::ranges::any_of(
        complex_.cells[cell].vertices,
        [&](uint32_t vertex) { return vertex < num_own_; });
  }

  // The cells in question that have a new vertex, or are beside one that has:
  // others have been searched before.
  // \param first_new  vertex of the last round
  std::vector<uint32_t> NewCells(uint32_t first_new) {
    is_used_.assign(complex_.cells.size(), 1);
    for (const uint32_t cell : complex_.free_cells) {
      is_used_[cell] = 0;
    }
    std::vector<uint32_t> cells;
    for (uint32_t cell = 0; cell < complex_.cells.size(); ++cell) {
      if (is_used_[cell] == 0 || !HasNewVertex(cell, first_new)) {
        continue;
      }
      const bool is_star = HasOwnVertex(cell);
      bool is_beside = false;
      for (const uint32_t mirror : complex_.cells[cell].mirror_facets) {
        if (is_star) {
          cells.push_back(mirror / 4);
        }
        is_beside = is_beside || HasOwnVertex(mirror / 4);
      }
      if (is_star || is_beside) {
        cells.push_back(cell);
      }
    }
    SortUnique(&cells);
    return cells;
  }

  bool HasNewVertex(uint32_t cell, uint32_t first_new) const {
    return std::ranges::any_of(
        complex_.cells[cell].vertices, [&](uint32_t vertex) {
          return vertex >= first_new && vertex != kInfiniteVertex;
        });
  }

  // The vertices to insert next, ascending.
  std::vector<uint32_t> FindMissing(uint32_t first_new) {
    const std::vector<uint32_t> cells = NewCells(first_new);
    std::vector<uint32_t> missing(cells.size());
    tbb::parallel_for(size_t{0}, cells.size(),
                      [&](size_t i) { missing[i] = FindInZone(cells[i]); });
    SortUnique(&missing);
    std::erase(missing, kNone);
    return missing;
  }

  // The deepest vertex in a cell's zone of conflict that is missing, of the
  // first block that has any; kNone where the zone is empty.
  uint32_t FindInZone(uint32_t cell) {
    const ConflictZone zone(complex_, cell);
    uint32_t found = kNone;
    tree_.Search(
        [&](const Eigen::AlignedBox3f& box) { return zone.MayTouch(box); },
        [&](uint32_t block) {
          found = FindInBlock(block, cell, zone);
          return found != kNone;
        });
    return found;
  }

  uint32_t FindInBlock(uint32_t block, uint32_t cell,
                       const ConflictZone& zone) {
    const std::vector<uint8_t>& is_loaded = is_loaded_[block];
    if (num_loaded_[block] == SizeOf(block)) {
      return kNone;
    }
    const auto vertices = ReadBlock(block);
    const std::vector<Eigen::Vector3f>& positions = vertices->positions;
    uint32_t deepest = kNone;
    double depth = 0;
    for (uint32_t i = 0; i < positions.size(); ++i) {
      if (i % kGroupVertices == 0 &&
          !zone.MayTouch(vertices->boxes[i / kGroupVertices])) {
        i += kGroupVertices - 1;
        continue;
      }
      if (!is_loaded.empty() && is_loaded[i] != 0) {
        continue;
      }
      const double at = zone.Depth(positions[i]);
      if (at >= depth && IsInConflict(complex_, cell, positions[i])) {
        deepest = blocks_.begins[block] + i;
        depth = at;
      }
    }
    return deepest;
  }

  // \param missing  ascending
  void Insert(const std::vector<uint32_t>& missing) {
    std::vector<Eigen::Vector3f> positions;
    for (const uint32_t id : missing) {
      const uint32_t block = blocks_.BlockOf(id);
      positions.push_back(Load(block, id - blocks_.begins[block]));
    }
    InsertMorePoints(positions, &complex_);
  }

  TileTetrahedra Finish(size_t num_rounds) {
    // The own vertices stay first.
    std::vector<uint32_t> order = Iota(ids_.size());
    std::sort(order.begin() + num_own_, order.end(),
              [&](uint32_t a, uint32_t b) { return ids_[a] < ids_[b]; });
    TileTetrahedra result;
    std::vector<uint32_t> numbers(ids_.size());
    for (uint32_t i = 0; i < order.size(); ++i) {
      numbers[order[i]] = i;
      result.ids.push_back(ids_[order[i]]);
    }
    result.tetrahedra = TakeTetrahedra(numbers, &complex_);
    result.num_own = num_own_;
    result.num_rounds = num_rounds;
    return result;
  }

  static constexpr size_t kCacheBytes = size_t{256} << 20;

  const PlanVertices& plan_;
  const PlanBlocks& blocks_;
  BoxTree tree_;
  LruCache<BlockVertices> cache_{kCacheBytes};
  // [blocks][vertices of the block] 1: in the complex; empty: none is.
  std::vector<std::vector<uint8_t>> is_loaded_;
  std::vector<uint32_t> num_loaded_;  // [blocks]
  Eigen::AlignedBox3f own_box_;
  uint32_t num_own_ = 0;
  std::vector<uint32_t> ids_;  // [complex points]
  GrowingComplex complex_;
  std::vector<uint8_t> is_used_;  // [cells] of a round
};

}  // namespace

TileTetrahedra CertifyTile(const PlanVertices& plan, uint32_t tile,
                           const Progress& progress) {
  Report(progress, kTriangulatingStage, 0);
  return Certifier(plan, tile).Run(progress);
}

}  // namespace colmap_ext
