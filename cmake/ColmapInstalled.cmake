# COLMAP from an installed prefix; see Colmap.cmake.

find_package(COLMAP QUIET)
if(NOT COLMAP_FOUND)
  message(FATAL_ERROR
    "colmap_ext needs COLMAP, built with CGAL. Two ways:\n"
    "  installed:  -DCMAKE_PREFIX_PATH=PREFIX, where PREFIX holds "
    "share/colmap/COLMAPConfig.cmake or share/colmap/colmap-config.cmake.\n"
    "  sources:    -DCOLMAP_SOURCE_DIR=DIR, an unpacked COLMAP source tree; it "
    "is copied and built here. On Debian 12 `scripts/get_colmap DIR` fetches "
    "one, and `scripts/build` does everything.\n"
    "Note that Debian's binary package `colmap` has neither headers nor CGAL. "
    "To build only src/ and its tests, pass -DCOLMAP_EXT_WITH_COLMAP=OFF.")
endif()

# 3.8 calls it COLMAP_CGAL_ENABLED.
set(colmap_cgal "${CGAL_ENABLED}")
if(DEFINED COLMAP_CGAL_ENABLED)
  set(colmap_cgal "${COLMAP_CGAL_ENABLED}")
endif()
colmap_ext_require_mvs("${MVS_ENABLED}" "The COLMAP in ${COLMAP_DIR}")
colmap_ext_require_cgal("${colmap_cgal}" "The COLMAP in ${COLMAP_DIR}")
set(COLMAP_EXT_COLMAP_VERSION_STRING ${COLMAP_VERSION})

if(TARGET colmap::colmap)
  target_link_libraries(colmap_ext_colmap INTERFACE colmap::colmap)
  # The target names the prefix that COLMAP was configured for, wherever it was
  # then installed.
  get_filename_component(colmap_prefix ${COLMAP_DIR}/../.. ABSOLUTE)
  target_include_directories(colmap_ext_colmap SYSTEM INTERFACE
                             ${colmap_prefix}/include)
else()  # 3.8: variables, without CGAL and OpenMP.
  find_package(OpenMP QUIET)
  target_compile_definitions(colmap_ext_colmap INTERFACE CGAL_ENABLED)
  target_include_directories(colmap_ext_colmap SYSTEM INTERFACE
                             ${COLMAP_INCLUDE_DIRS})
  target_link_directories(colmap_ext_colmap INTERFACE ${COLMAP_LINK_DIRS})
  target_link_libraries(colmap_ext_colmap INTERFACE
                        ${COLMAP_LIBRARIES} CGAL::CGAL
                        $<TARGET_NAME_IF_EXISTS:OpenMP::OpenMP_CXX>)
endif()
