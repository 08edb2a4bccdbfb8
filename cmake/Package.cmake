# `cmake --build build/release --target package` makes a Debian package of the
# stand-alone program, its manual pages, completion and docs. The patched
# `colmap` is left out: it would take the place of COLMAP's own.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME colmap-ext)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "colmap_ext developers <developers@colmap-ext.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY
    "accurate, manifold meshes from COLMAP's dense workspaces")
set(CPACK_PACKAGE_DESCRIPTION
    "Meshes the fused points of COLMAP's stereo_fusion by a visibility cut of
their Delaunay tetrahedra, without singular vertices, and refines the mesh by
the photographs, each face by the images that see it best.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL Unspecified)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Loaded when the program draws: OpenGL, by a card or by Mesa.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libegl1, libgl1, libgl1-mesa-dri")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS colmap)
include(CPack)
