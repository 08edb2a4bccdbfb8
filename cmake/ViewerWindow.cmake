# colmap_ext_window: the viewer's window, by GLFW and Dear ImGui where both are
# there, else one that says what is missing.
find_package(glfw3 3.3 QUIET)
find_path(IMGUI_INCLUDE_DIR imgui.h PATH_SUFFIXES imgui)
find_library(IMGUI_LIBRARY imgui)
find_library(STB_LIBRARY stb)  # Debian's ImGui has its fonts from there.
mark_as_advanced(IMGUI_INCLUDE_DIR IMGUI_LIBRARY STB_LIBRARY)
add_module(no_window DEPENDS viewer)  # Built in any case, so that it is checked.
option(COLMAP_EXT_WINDOW "Build the viewer's window, if GLFW is there" ON)
if(COLMAP_EXT_WINDOW AND glfw3_FOUND AND IMGUI_INCLUDE_DIR AND IMGUI_LIBRARY)
  add_library(colmap_ext_imgui INTERFACE)
  target_include_directories(colmap_ext_imgui SYSTEM INTERFACE
                             ${IMGUI_INCLUDE_DIR})
  target_link_libraries(colmap_ext_imgui INTERFACE
                        ${IMGUI_LIBRARY} ${CMAKE_DL_LIBS}
                        $<$<BOOL:${STB_LIBRARY}>:${STB_LIBRARY}>)
  add_module(viewer_window DEPENDS viewer
             PRIVATE_LIBS colmap_ext_imgui glfw fmt::fmt)
  add_library(colmap_ext_window ALIAS colmap_ext_viewer_window)
else()
  message(STATUS "No GLFW or Dear ImGui: mesh_viewer draws pictures only")
  add_library(colmap_ext_window ALIAS colmap_ext_no_window)
endif()
