# Lets COLMAP's automatic_reconstructor, its window, and the scripts that
# image_undistorter writes use the commands of colmap_ext.
#
#   colmap_ext_patch_reconstructor(<COLMAP's source tree>)
#
# What is inserted stands beside lines that are the same from COLMAP 3.8 to 4.1,
# where their surroundings are not, so that no patch file would apply to all.
# COLMAP's libraries cannot link ours; they call what colmap_ext/dense_meshing.h
# finds, which the program sets (colmap_commands.patch).

# Replaces what a regular expression finds, which has to be there once.
function(colmap_ext_replace file regex replacement)
  file(READ ${file} text)
  string(REPLACE ";" "<semicolon>" text "${text}")  # Or CMake sees a list.
  string(REGEX MATCHALL "${regex}" found "${text}")
  list(LENGTH found count)
  if(NOT count EQUAL 1)
    message(FATAL_ERROR
      "${file} is not as in COLMAP 3.8 to 4.1: '${regex}' is there ${count} "
      "times.\nPass unchanged sources of COLMAP. If this is a version that "
      "colmap_ext does not know, pass -DCOLMAP_EXT_PATCH_COLMAP=OFF: the "
      "stand-alone program colmap_ext runs the same commands.")
  endif()
  string(REGEX REPLACE "${regex}" "${replacement}" text "${text}")
  string(REPLACE "<semicolon>" ";" text "${text}")
  file(WRITE ${file} "${text}")
endfunction()

# The choice of the mesher, and whether to refine.
function(colmap_ext_patch_options source)
  set(header ${source}/controllers/automatic_reconstruction.h)
  colmap_ext_replace(${header} "(POISSON, DELAUNAY(, [A-Z_]+)*)( ?[})])"
    "\\1, DELAUNAY_MANIFOLD\\3")
  colmap_ext_replace(${header} "    Mesher mesher = Mesher::POISSON[^\n]*\n"
    "\\0
    // Whether to refine the mesh by its images.
    bool refine_mesh = false;\n")
  set(command ${source}/exe/sfm.cc)
  colmap_ext_replace(${command}
    "\"{poisson, delaunay}\"\\)[^\n]*\n"
    "\"{poisson, delaunay, delaunay_manifold}\");
  options.AddDefaultOption(\"refine_mesh\",
                           &reconstruction_options.refine_mesh,
                           \"Refine the mesh by its images\");\n")
  file(READ ${command} text)
  if(text MATCHES "if \\(mesher == \"poisson\"\\)")  # Before 3.12.
    colmap_ext_replace(${command} "if \\(mesher == \"poisson\"\\) {"
      "if (mesher == \"delaunay_manifold\") {
    reconstruction_options.mesher =
        AutomaticReconstructionController::Mesher::DELAUNAY_MANIFOLD;
  } else \\0")
  endif()
endfunction()

# The window: an entry behind all others, whose number is theirs.
function(colmap_ext_patch_window source)
  set(widget ${source}/ui/automatic_reconstruction_widget.cc)
  file(READ ${widget} text)
  string(REGEX MATCHALL "mesher_cb_->addItem" items "${text}")
  list(LENGTH items index)
  colmap_ext_replace(${widget} "  mesher_cb_->setCurrentIndex[^\n]*\n"
    "  mesher_cb_->addItem(\"Delaunay, manifold\");\n\\0")
  colmap_ext_replace(${widget}
    "switch \\(mesher_cb_->currentIndex\\(\\)\\) {\n"
    "\\0    case ${index}:
      options_.mesher =
          AutomaticReconstructionController::Mesher::DELAUNAY_MANIFOLD;
      break;\n")
  # From 4.0 on it shows the mesh.
  if(text MATCHES "meshing_path = dense_path / \"meshed-delaunay.ply\"")
    colmap_ext_replace(${widget}
      "    } else {\n      meshing_path = dense_path / \"meshed-delaunay.ply\""
      "    } else if (options_.mesher ==
               AutomaticReconstructionController::Mesher::DELAUNAY_MANIFOLD) {
      meshing_path = dense_path / \"meshed-delaunay-manifold.ply\";
\\0")
  endif()
endfunction()

# The reconstruction itself.
function(colmap_ext_patch_controller source)
  set(controller ${source}/controllers/automatic_reconstruction.cc)
  colmap_ext_replace(${controller}
    "#include \"[a-z/]*controllers/automatic_reconstruction.h\"\n"
    "\\0\n#include \"colmap_ext/dense_meshing.h\"\n")
  colmap_ext_replace(${controller}
    "    if \\(ExistsFile\\(fused_path\\) && ExistsFile\\(meshing_path\\)\\) {\n"
    "    if (options_.mesher == Mesher::DELAUNAY_MANIFOLD) {
      meshing_path = colmap_ext::ManifoldMeshPath(dense_path);
    }

\\0")
  colmap_ext_replace(${controller} "\n    RunDenseMapper\\(\\)[^\n]*\n"
    "\\0    if (!IsStopped()) {
      colmap_ext::DenseMeshingRequest request;
      request.workspace_path = options_.workspace_path;
      request.num_workspaces = reconstruction_manager_->Size();
      request.mesher = static_cast<int>(options_.mesher);
      request.is_manifold = options_.mesher == Mesher::DELAUNAY_MANIFOLD;
      request.is_refined = options_.refine_mesh;
      request.quality = static_cast<int>(options_.quality);
      request.num_threads = options_.num_threads;
      colmap_ext::FinishDenseWorkspaces(request);
    }\n")
endfunction()

# run-colmap-geometric.sh and run-colmap-photometric.sh.
function(colmap_ext_patch_scripts source)
  foreach(name base/undistortion.cc image/undistortion.cc
               controllers/undistorters.cc)
    set(file ${source}/${name})
    if(EXISTS ${file})
      file(READ ${file} text)
      if(text MATCHES "meshed-delaunay.ply")
        break()
      endif()
    endif()
  endforeach()
  colmap_ext_replace(${file} "meshed-delaunay.ply[^}]*}"
    "\\0\n// colmap_ext: the end of WriteCOLMAPCommands")
  colmap_ext_replace(${file}
    "}\n// colmap_ext: the end of WriteCOLMAPCommands"
    "  colmap_ext::WriteMeshingCommands(
      workspace_path, workspace_format, indent, file);\n}")
  colmap_ext_replace(${file} "#include \"[a-z/]*undistort[a-z]*.h\"\n"
    "\\0\n#include \"colmap_ext/dense_meshing.h\"\n")
endfunction()

function(colmap_ext_patch_reconstructor tree)
  set(source ${tree}/src/colmap)
  if(NOT IS_DIRECTORY ${source})  # 3.8
    set(source ${tree}/src)
  endif()
  colmap_ext_patch_options(${source})
  colmap_ext_patch_window(${source})
  colmap_ext_patch_controller(${source})
  colmap_ext_patch_scripts(${source})
endfunction()
