#include "colmap_ext/jobs/refinement_job.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "colmap_ext/jobs/surface_files.h"
#include "formats/errors.h"
#include "mesh/adjacency.h"
#include "mesh/manifold_repair.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// A vertex of the whole may have several fans in a part.
SurfacePart SplitPart(SurfacePart part) {
  const FanSplit split = SplitFans(part.mesh);
  SurfacePart result;
  result.mesh = split.mesh;
  result.facet_ids = std::move(part.facet_ids);
  for (const auto& source : split.from.vertices) {
    result.ids.push_back(part.ids[source[0]]);
    AddAttributes(part.attributes, source[0], &result.attributes);
  }
  return result;
}

}  // namespace

Eigen::AlignedBox3f RefinementJob::Reach() const {
  return GrowBox(cells[tile],
                 static_cast<float>(refinement.tiles[tile].margin));
}

bool RefinementJob::IsFree(const Eigen::Vector3f& vertex) const {
  return Reach().contains(vertex) &&
         Color(CellOf(cells, vertex)) >= Color(tile);
}

RefinementJob MakeRefinementJob(const fs::path& folder, uint32_t tile) {
  RefinementJob job{folder, tile, ReadPlan(folder, tile), {}, {}, {}};
  job.refinement = ReadRefinementPlan(folder, job.plan);
  job.cells = job.plan.Cells();
  job.before = job.refinement.TilesBefore(job.Color(tile));
  return job;
}

void ExpectRefined(const fs::path& folder, const RefinementPlan& plan,
                   const std::vector<uint32_t>& tiles) {
  for (const uint32_t tile : tiles) {
    if (!HasPatch(folder, plan.identity, tile)) {
      throw FileError(
          PatchPath(folder, tile),
          fmt::format("tile {} of colour {} is not refined: run "
                      "facetwise_refiner --plan_path {} --tile {} first",
                      tile, plan.tiles[tile].color, folder.string(), tile));
    }
  }
}

RefinementTarget FindTarget(const RefinementJob& job,
                            const SurfaceStore& store) {
  const Eigen::AlignedBox3f reach = job.Reach();
  const SurfacePart part = GatherSurface(
      store, job.before,
      [&](const Eigen::AlignedBox3f& box) { return reach.intersects(box); });
  RefinementTarget target;
  std::set<uint32_t> views;
  std::vector<uint8_t> is_free;
  for (size_t i = 0; i < part.ids.size(); ++i) {
    is_free.push_back(job.IsFree(part.mesh.vertices[i]) ? 1 : 0);
    if (is_free[i] != 0) {
      const auto row = part.attributes.views[i];
      views.insert(row.begin(), row.end());
    }
  }
  for (const Facet& facet : part.mesh.facets) {
    if (is_free[facet[0]] + is_free[facet[1]] + is_free[facet[2]] > 0) {
      target.box.extend(BoxOf(part.mesh, facet));
    }
  }
  target.views.assign(views.begin(), views.end());
  return target;
}

SurfacePart GatherPart(const RefinementJob& job, const RefinementTarget& target,
                       const SurfaceStore& store) {
  std::vector<Eigen::Vector3f> centers;
  for (const uint32_t view : target.views) {
    centers.emplace_back(job.plan.views[view].Center().cast<float>());
  }
  return SplitPart(
      GatherSurface(store, job.before, [&](const Eigen::AlignedBox3f& box) {
        return box.intersects(target.box) ||
               std::ranges::any_of(centers, [&](const Eigen::Vector3f& center) {
                 return MayHide(box, center, target.box);
               });
      }));
}

FixedVertices FixedIn(const RefinementJob& job, const SurfacePart& part) {
  FixedVertices fixed;
  for (const Eigen::Vector3f& vertex : part.mesh.vertices) {
    fixed.push_back(job.IsFree(vertex) ? 0 : 1);
  }
  return fixed;
}

}  // namespace colmap_ext
