# A module is a folder under src/ and a static library colmap_ext_<name>.
#
#   add_module(<name> [DEPENDS <module>...] [LIBS <target>...]
#              [PRIVATE_LIBS <target>...] [WITHOUT <file>...])
#
# WITHOUT lists sources that are not compiled. The files of a module are
# included as "<name>/file.h". Its include folder holds nothing but a link to
# it, so including a module that is not among DEPENDS, or among what these
# depend on, fails at build.
function(add_module name)
  cmake_parse_arguments(MODULE "" "" "DEPENDS;LIBS;PRIVATE_LIBS;WITHOUT"
                        ${ARGN})
  set(dir ${PROJECT_SOURCE_DIR}/src/${name})
  set(include_dir ${PROJECT_BINARY_DIR}/include/${name})
  set(target colmap_ext_${name})

  file(MAKE_DIRECTORY ${include_dir})
  file(CREATE_LINK ${dir} ${include_dir}/${name} SYMBOLIC)

  file(GLOB sources CONFIGURE_DEPENDS ${dir}/*.cc)
  list(TRANSFORM MODULE_WITHOUT PREPEND ${dir}/)
  list(REMOVE_ITEM sources ${MODULE_WITHOUT})
  if(sources)
    add_library(${target} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE colmap_ext_flags
                                            ${MODULE_PRIVATE_LIBS})
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    colmap_ext_compile_in_batches(${target})
  else()  # Headers only.
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()

  list(TRANSFORM MODULE_DEPENDS PREPEND colmap_ext_)
  target_include_directories(${target} ${scope} ${include_dir})
  target_link_libraries(${target} ${scope} ${MODULE_DEPENDS} ${MODULE_LIBS})
endfunction()
