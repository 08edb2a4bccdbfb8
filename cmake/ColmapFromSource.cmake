# COLMAP from a source tree; see Colmap.cmake.
#
# The tree is copied because configuring COLMAP writes into it and patches/
# change it. The files of the copy get new time stamps, or the files of another
# version could look older than what was built before.

option(COLMAP_EXT_PATCH_COLMAP
       "Let COLMAP's own program run our commands too (patches/)" ON)

set(colmap_copy ${PROJECT_BINARY_DIR}/colmap/source)
set(colmap_build ${PROJECT_BINARY_DIR}/colmap/build)

# project(COLMAP) overwrites the cache entry COLMAP_SOURCE_DIR with the copy's
# path. It is put back below, and here after a configure that stopped between.
if(COLMAP_SOURCE_DIR STREQUAL colmap_copy)
  set(COLMAP_SOURCE_DIR ${COLMAP_EXT_COLMAP_TREE} CACHE PATH "" FORCE)
endif()
set(COLMAP_EXT_COLMAP_TREE ${COLMAP_SOURCE_DIR} CACHE INTERNAL "")

# Which layout.
if(EXISTS ${COLMAP_SOURCE_DIR}/src/exe/colmap.cc)  # 3.8
  set(colmap_main src/exe/colmap.cc)
  set(colmap_program colmap_exe)
elseif(EXISTS ${COLMAP_SOURCE_DIR}/src/colmap/exe/colmap.cc)  # 3.9 and newer
  set(colmap_main src/colmap/exe/colmap.cc)
  set(colmap_program colmap_main)
else()
  message(FATAL_ERROR
    "COLMAP_SOURCE_DIR=${COLMAP_SOURCE_DIR} does not look like COLMAP 3.8 or "
    "newer: it has neither src/exe/colmap.cc nor src/colmap/exe/colmap.cc.\n"
    "Pass the top folder of an unpacked COLMAP source tree; on Debian 12 "
    "`scripts/get_colmap DIR` fetches one.")
endif()

# Which version: set(COLMAP_VERSION "3.8") or project(... VERSION 3.13.0).
file(READ ${COLMAP_SOURCE_DIR}/CMakeLists.txt colmap_cmakelists)
if(colmap_cmakelists MATCHES "COLMAP_VERSION[ \t]+\"([0-9][0-9.]*)")
  set(COLMAP_EXT_COLMAP_VERSION_STRING ${CMAKE_MATCH_1})
elseif(colmap_cmakelists MATCHES
       "project\\([^)]*VERSION[ \t\r\n]+\"?([0-9][0-9.]*)")
  set(COLMAP_EXT_COLMAP_VERSION_STRING ${CMAKE_MATCH_1})
else()
  message(FATAL_ERROR "COLMAP of an unknown layout: no version found in "
                      "${COLMAP_SOURCE_DIR}/CMakeLists.txt.")
endif()

# The copy, made anew when what is copied changes.
file(GLOB_RECURSE colmap_files
  ${COLMAP_SOURCE_DIR}/CMakeLists.txt
  ${COLMAP_SOURCE_DIR}/cmake/*
  ${COLMAP_SOURCE_DIR}/lib/*
  ${COLMAP_SOURCE_DIR}/src/*)
set(colmap_patches "")
set(colmap_insertions "")
if(COLMAP_EXT_PATCH_COLMAP)
  file(GLOB colmap_patches CONFIGURE_DEPENDS
       ${PROJECT_SOURCE_DIR}/patches/*.patch)
  set(colmap_insertions
      ${PROJECT_SOURCE_DIR}/patches/automatic_reconstructor.cmake)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
               ${colmap_patches} ${colmap_insertions})
  include(${colmap_insertions})
endif()
set(colmap_digest "")
foreach(file IN LISTS colmap_files colmap_patches colmap_insertions)
  file(SHA256 ${file} digest)
  string(APPEND colmap_digest "${digest}\n")
endforeach()
string(SHA256 colmap_digest "${colmap_digest}")

set(colmap_stamp ${PROJECT_BINARY_DIR}/colmap/source.sha256)
set(colmap_copied "")
if(EXISTS ${colmap_stamp})
  file(READ ${colmap_stamp} colmap_copied)
endif()

if(NOT colmap_copied STREQUAL colmap_digest
   OR NOT EXISTS ${colmap_copy}/CMakeLists.txt)
  message(STATUS "Copying COLMAP's sources from ${COLMAP_SOURCE_DIR}")
  file(REMOVE_RECURSE ${colmap_stamp} ${colmap_copy})
  file(COPY ${COLMAP_SOURCE_DIR}/ DESTINATION ${colmap_copy}
       PATTERN ".git" EXCLUDE
       PATTERN "_build" EXCLUDE
       PATTERN "build" EXCLUDE)
  file(GLOB_RECURSE colmap_files ${colmap_copy}/*)
  file(TOUCH ${colmap_files})

  file(READ ${colmap_copy}/${colmap_main} colmap_main_text)
  if(colmap_patches AND NOT colmap_main_text MATCHES "colmap_ext/commands.h")
    find_program(PATCH_PROGRAM patch REQUIRED)
    mark_as_advanced(PATCH_PROGRAM)
    foreach(file IN LISTS colmap_patches)
      # The patch names the file as in 3.8. Naming it here serves both layouts.
      execute_process(
        COMMAND ${PATCH_PROGRAM} --batch --forward --fuzz=0 --no-backup-if-mismatch
                ${colmap_copy}/${colmap_main} ${file}
        RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
      if(NOT result EQUAL 0)
        message(FATAL_ERROR
          "${file} does not apply to COLMAP ${COLMAP_EXT_COLMAP_VERSION_STRING} "
          "in ${COLMAP_SOURCE_DIR}:\n${output}\n"
          "Pass unchanged sources of COLMAP. If this is a version that the "
          "patch does not know, pass -DCOLMAP_EXT_PATCH_COLMAP=OFF: the "
          "stand-alone program colmap_ext runs the same commands.")
      endif()
    endforeach()
    colmap_ext_patch_reconstructor(${colmap_copy})
  endif()
  file(WRITE ${colmap_stamp} ${colmap_digest})
endif()

# Headless; -DNAME=ON overrides. CCACHE_ENABLED: see Ccache.cmake.
foreach(option IN ITEMS GUI_ENABLED OPENGL_ENABLED CUDA_ENABLED TESTS_ENABLED
                        BOOST_STATIC CCACHE_ENABLED)
  set(${option} OFF CACHE BOOL "COLMAP's option")
endforeach()
set(CGAL_ENABLED ON CACHE BOOL "COLMAP's option")
set(CMAKE_POLICY_VERSION_MINIMUM 3.5)  # 3.8 asks for CMake 3.1.
set(CMAKE_POLICY_DEFAULT_CMP0074 NEW)  # Or it warns.
add_subdirectory(${colmap_copy} ${colmap_build} EXCLUDE_FROM_ALL)
set(COLMAP_SOURCE_DIR ${COLMAP_EXT_COLMAP_TREE} CACHE PATH
    "COLMAP source tree to build against; empty: find_package(COLMAP)" FORCE)
unset(CMAKE_POLICY_VERSION_MINIMUM)
unset(CMAKE_POLICY_DEFAULT_CMP0074)

get_directory_property(colmap_mvs DIRECTORY ${colmap_copy}
                       DEFINITION MVS_ENABLED)
colmap_ext_require_mvs("${colmap_mvs}" "COLMAP")
# COLMAP turns CGAL off by itself when it does not find it.
get_directory_property(colmap_cgal DIRECTORY ${colmap_copy}
                       DEFINITION CGAL_ENABLED)
colmap_ext_require_cgal("${colmap_cgal}" "COLMAP")
if(NOT TARGET ${colmap_program})
  message(FATAL_ERROR "COLMAP of an unknown layout: it makes no target "
                      "${colmap_program}.")
endif()
set_target_properties(${colmap_program} PROPERTIES
                      RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
if(COLMAP_EXT_PATCH_COLMAP)
  set(COLMAP_EXT_COLMAP_EXE ${colmap_program})
  # What the patched sources include.
  foreach(target colmap colmap_controllers colmap_image)
    if(TARGET ${target})
      get_target_property(type ${target} TYPE)
      if(NOT type STREQUAL INTERFACE_LIBRARY)
        target_include_directories(${target} PRIVATE
                                   ${PROJECT_BINARY_DIR}/include/colmap_ext)
      endif()
    endif()
  endforeach()
endif()

# COLMAP's definitions and, in 3.8, include directories are set on its folders
# rather than on its targets. Later ones are repeated to make them SYSTEM.
find_package(OpenMP QUIET)
get_directory_property(colmap_definitions DIRECTORY ${colmap_copy}
                       COMPILE_DEFINITIONS)
get_directory_property(colmap_includes DIRECTORY ${colmap_copy}
                       INCLUDE_DIRECTORIES)
target_compile_definitions(colmap_ext_colmap INTERFACE ${colmap_definitions})
target_include_directories(colmap_ext_colmap SYSTEM INTERFACE
                           ${colmap_includes})
# The commands need not wait for all of COLMAP. From 3.9 on it is many libraries;
# 3.8 is one, of 130 files; the seven that read pictures become another.
set(colmap_pictures colmap)
if(TARGET colmap_sensor AND TARGET colmap_util)
  set(colmap_pictures colmap_sensor colmap_util)
elseif(EXISTS ${colmap_copy}/src/util/bitmap.cc)
  set(colmap_pictures colmap_pictures)
  set(sources base/camera_database util/bitmap util/camera_specs util/logging
              util/misc util/string util/version)
  list(TRANSFORM sources PREPEND ${colmap_copy}/src/)
  list(TRANSFORM sources APPEND .cc)
  add_library(colmap_pictures STATIC EXCLUDE_FROM_ALL ${sources})
  target_compile_features(colmap_pictures PRIVATE cxx_std_14)
  target_compile_definitions(colmap_pictures PRIVATE ${colmap_definitions})
  target_include_directories(colmap_pictures SYSTEM PRIVATE ${colmap_includes})
  get_directory_property(colmap_external DIRECTORY ${colmap_copy}
                         DEFINITION COLMAP_EXTERNAL_LIBRARIES)
  target_link_libraries(colmap_pictures PUBLIC vlfeat ${colmap_external})
  get_target_property(colmap_sources colmap SOURCES)
  list(REMOVE_ITEM colmap_sources ${sources})
  set_target_properties(colmap PROPERTIES SOURCES "${colmap_sources}")
  target_link_libraries(colmap colmap_pictures)
  # In batches as our own sources, but for those that take gigabytes, and two
  # that COLMAP's program has too. With CUDA or Qt this is not tested.
  if(COLMAP_EXT_UNITY_BUILD AND NOT CUDA_ENABLED AND NOT GUI_ENABLED)
    file(GLOB alone ${colmap_copy}/src/estimators/*.cc)
    list(APPEND alone ${colmap_copy}/src/optim/bundle_adjustment.cc
         ${colmap_copy}/src/exe/feature.cc ${colmap_copy}/src/exe/sfm.cc)
    set_source_files_properties(${alone} TARGET_DIRECTORY colmap
                                PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    set_target_properties(colmap PROPERTIES UNITY_BUILD ON)
  endif()
endif()
target_link_libraries(colmap_ext_colmap INTERFACE
                      ${colmap_pictures} CGAL::CGAL
                      $<TARGET_NAME_IF_EXISTS:OpenMP::OpenMP_CXX>)
target_link_libraries(colmap_ext_colmap_models INTERFACE
                      colmap CGAL::CGAL
                      $<TARGET_NAME_IF_EXISTS:OpenMP::OpenMP_CXX>)
