# embed_shaders(<target>): makes the files of shaders/ part of a target, as what
# src/gl/gl_objects.h declares. Run as a script, writes OUTPUT from SHADERS.
#
# A line `#include "file"` stands for that file, of the same folder.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(COLMAP_EXT_EMBED_SHADERS ${CMAKE_CURRENT_LIST_FILE})

  function(embed_shaders target)
    file(GLOB shaders CONFIGURE_DEPENDS
         ${PROJECT_SOURCE_DIR}/shaders/*.vert
         ${PROJECT_SOURCE_DIR}/shaders/*.frag
         ${PROJECT_SOURCE_DIR}/shaders/*.comp)
    file(GLOB included CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/shaders/*.glsl)
    set(output ${CMAKE_CURRENT_BINARY_DIR}/shader_sources.cc)
    add_custom_command(
      OUTPUT ${output}
      COMMAND ${CMAKE_COMMAND} "-DSHADERS=${shaders}" -DOUTPUT=${output}
              -P ${COLMAP_EXT_EMBED_SHADERS}
      DEPENDS ${shaders} ${included} ${COLMAP_EXT_EMBED_SHADERS}
      COMMENT "Embedding the shaders"
      VERBATIM)
    target_sources(${target} PRIVATE ${output})
    # The batches can be checked before this is made.
    set_source_files_properties(${output} PROPERTIES
      SKIP_UNITY_BUILD_INCLUSION ON)
  endfunction()
  return()
endif()

set(cases "")
foreach(shader IN LISTS SHADERS)
  get_filename_component(name ${shader} NAME)
  get_filename_component(folder ${shader} DIRECTORY)
  file(READ ${shader} source)
  while(source MATCHES "#include \"([^\"]+)\"")
    set(line "${CMAKE_MATCH_0}")
    file(READ ${folder}/${CMAKE_MATCH_1} included)
    string(REPLACE "${line}" "${included}" source "${source}")
  endwhile()
  string(APPEND cases
         "  if (name == \"${name}\") {\n"
         "    return R\"glsl(${source})glsl\";\n"
         "  }\n")
endforeach()
file(WRITE ${OUTPUT} "#include \"gl/gl_objects.h\"

#include <stdexcept>
#include <string>

namespace colmap_ext {

std::string_view ShaderSource(std::string_view name) {
${cases}  throw std::out_of_range(\"no shader \" + std::string(name));
}

}  // namespace colmap_ext
")
