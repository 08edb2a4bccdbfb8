#pragma once

#include <filesystem>

#include "colmap_ext/jobs/plan.h"
#include "colmap_ext/options/refinement_options.h"
#include "colmap_ext/report/print_report.h"
#include "refine/facetwise_refinement.h"
#include "scene/images.h"
#include "scene/progress.h"

// The jobs that refine the mesh of a plan tile by tile.
namespace colmap_ext {

// Plans how the mesh of a plan, options.input_path, is refined tile by tile:
// refines the cameras by it if they are to be, copies it into the plan's
// folder, in blocks that jobs read where they need them, and gives tiles
// colours. Holds the mesh. Prints the commands of the jobs.
// \pre the mesh is as mesh_merger has written it, with its .vis
// \throw FileError if a file is missing, damaged, or of another plan, or
//        cannot be written, or where another planner is at work
void PlanRefinement(const RefinerOptions& options,
                    const PictureDecoder& decoder, Console* console);

// Where a plan's pictures lie, and its masks; none if it has none.
// \throw FileError if no image has a mask
std::filesystem::path ImagesPath(const Plan& plan);
ReadGrayImage MasksOf(const Plan& plan, const PictureDecoder& decoder);

// Sets the cameras of a plan's refinement: the plan's or, if they are to be
// refined and need it, AlignCameras()'s, which it also writes.
// \throw FileError if the sparse model or a picture cannot be used
void RefineCameras(const RefinerOptions& options, const Plan& plan,
                   const PictureDecoder& decoder, Console* console,
                   const Surface& surface, RefinementPlan* refinement);

// \throw FileError if one of the tiles is not refined
void ExpectRefined(const RefinementPlan& plan,
                   const std::vector<uint32_t>& tiles);

// The job that refines a tile of a plan, once: its file is complete or does not
// exist.
//
// The job's facets are those in the tile's cell and a margin around it, except
// those that the tiles of lower colours have refined in their own cells. All
// other facets are fixed; they are read if they may hide the tile from a
// camera.
//
// \param options  how to compute; what to compute comes from the plan
// \throw FileError if there is no such tile, no plan of its refinement, or
//        something is missing, damaged, of another plan, or has changed;
//        Interruption if a signal ended it
void RefineTile(RefinerOptions options, const PictureDecoder& decoder,
                Console* console);

// The refined surface of a plan, all of whose tiles are refined: their patches
// put together, borders and self-intersections as RefineFacetwise() leaves
// them.
// \throw FileError if a tile is not refined, or patches do not fit together
RefinedMesh MergeRefined(const std::filesystem::path& folder,
                         const Progress& progress);

}  // namespace colmap_ext
