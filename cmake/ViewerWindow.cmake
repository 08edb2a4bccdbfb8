# The viewer's window, by GLFW and Dear ImGui if both are there; otherwise a stub
# that says what is missing. Sets, for src/viewer,
#   viewer_window_libs    the libraries that the window needs
#   viewer_window_unused  the sources that are not compiled
find_package(glfw3 3.3 QUIET)
find_path(IMGUI_INCLUDE_DIR imgui.h PATH_SUFFIXES imgui)
find_library(IMGUI_LIBRARY imgui)
find_library(STB_LIBRARY stb)  # Debian's ImGui has its fonts from there.
mark_as_advanced(IMGUI_INCLUDE_DIR IMGUI_LIBRARY STB_LIBRARY)
option(COLMAP_EXT_WINDOW "Build the viewer's window, if GLFW is there" ON)
if(COLMAP_EXT_WINDOW AND glfw3_FOUND AND IMGUI_INCLUDE_DIR AND IMGUI_LIBRARY)
  add_library(colmap_ext_imgui INTERFACE)
  target_include_directories(colmap_ext_imgui SYSTEM INTERFACE
                             ${IMGUI_INCLUDE_DIR})
  target_link_libraries(colmap_ext_imgui INTERFACE
                        ${IMGUI_LIBRARY} ${CMAKE_DL_LIBS}
                        $<$<BOOL:${STB_LIBRARY}>:${STB_LIBRARY}>)
  set(viewer_window_libs colmap_ext_imgui glfw)
  set(viewer_window_unused no_window.cc)
else()
  message(STATUS "No GLFW or Dear ImGui: mesh_viewer draws pictures only")
  set(viewer_window_libs "")
  set(viewer_window_unused glfw_window.cc overlay.cc viewer_window.cc)
endif()
