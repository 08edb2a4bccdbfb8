# Compiles through ccache so that a clone at another path, or another build
# folder, hits the same entries: paths are hashed relative to the source tree.
# Set here rather than in a script, so that a build by hand behaves the same.

if(NOT COLMAP_EXT_CCACHE OR CMAKE_CXX_COMPILER_LAUNCHER)
  return()
endif()

find_program(CCACHE_PROGRAM ccache)
mark_as_advanced(CCACHE_PROGRAM)
if(NOT CCACHE_PROGRAM)
  return()
endif()

set(colmap_ext_launcher
    env
    CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
    CCACHE_NOHASHDIR=1
    CCACHE_COMPILERCHECK=content
    ${CCACHE_PROGRAM})
set(CMAKE_C_COMPILER_LAUNCHER ${colmap_ext_launcher})
set(CMAKE_CXX_COMPILER_LAUNCHER ${colmap_ext_launcher})
