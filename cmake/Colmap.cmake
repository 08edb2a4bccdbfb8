# Finds or builds COLMAP and wraps it into two targets:
#   colmap_ext_colmap         its pictures, logging and version, which is all that
#                             the commands need
#   colmap_ext_colmap_models  all of it, for the tests and COLMAP's own program
#
# Two ways, the second when COLMAP_SOURCE_DIR is given:
#   installed  find_package(COLMAP); 3.8 sets variables, 3.9+ has colmap::colmap.
#   source     the tree is copied into the build tree, patched from patches/ and
#              built headless; sets COLMAP_EXT_COLMAP_EXE to the target of its
#              command-line program, which then runs our commands too.
#
# Our code learns the version from COLMAP_EXT_COLMAP_VERSION, an integer
# major * 10000 + minor * 100 + patch: 30800 is 3.8, 31200 is 3.12, 40000 is 4.0.
# Before 3.9 COLMAP's headers are included as "base/...", "util/...", later as
# "colmap/scene/...", "colmap/util/...".

set(COLMAP_EXT_COLMAP_EXE "")

function(colmap_ext_version_number version out)
  if(NOT version MATCHES "^([0-9]+)\\.([0-9]+)(\\.([0-9]+))?")
    message(FATAL_ERROR "Cannot read COLMAP's version from '${version}'.")
  endif()
  set(patch 0)
  if(CMAKE_MATCH_4)
    set(patch ${CMAKE_MATCH_4})
  endif()
  math(EXPR number
       "${CMAKE_MATCH_1} * 10000 + ${CMAKE_MATCH_2} * 100 + ${patch}")
  if(number LESS 30800)
    message(FATAL_ERROR
      "COLMAP ${version} is too old: colmap_ext needs 3.8 or newer.")
  endif()
  set(${out} ${number} PARENT_SCOPE)
endfunction()

# COLMAP 4.1 can be built without its dense part. Earlier ones do not know the
# option, which is empty then.
function(colmap_ext_require_mvs enabled where)
  if(NOT "${enabled}" STREQUAL "" AND NOT enabled)
    message(FATAL_ERROR
      "${where} was configured with MVS_ENABLED=OFF, so it has no dense "
      "workspaces, which colmap_ext's commands are for.\n"
      "Configure COLMAP with -DMVS_ENABLED=ON.")
  endif()
endfunction()

function(colmap_ext_require_cgal enabled where)
  if(NOT enabled)
    message(FATAL_ERROR
      "${where} was configured without CGAL, so it has no delaunay_mesher and "
      "colmap_ext cannot share its dependencies.\n"
      "Install CGAL (Debian: libcgal-dev) and configure COLMAP with "
      "-DCGAL_ENABLED=ON, or pass COLMAP's sources to colmap_ext with "
      "-DCOLMAP_SOURCE_DIR=DIR.")
  endif()
endfunction()

add_library(colmap_ext_colmap INTERFACE)
add_library(colmap_ext_colmap_models INTERFACE)
target_link_libraries(colmap_ext_colmap_models INTERFACE colmap_ext_colmap)
if(COLMAP_SOURCE_DIR)
  include(${CMAKE_CURRENT_LIST_DIR}/ColmapFromSource.cmake)
else()
  include(${CMAKE_CURRENT_LIST_DIR}/ColmapInstalled.cmake)
endif()

colmap_ext_version_number("${COLMAP_EXT_COLMAP_VERSION_STRING}"
                          COLMAP_EXT_COLMAP_VERSION)
target_compile_definitions(colmap_ext_colmap INTERFACE
  COLMAP_EXT_COLMAP_VERSION=${COLMAP_EXT_COLMAP_VERSION})
message(STATUS "COLMAP ${COLMAP_EXT_COLMAP_VERSION_STRING} "
               "(COLMAP_EXT_COLMAP_VERSION=${COLMAP_EXT_COLMAP_VERSION})")
