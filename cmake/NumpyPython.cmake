# COLMAP_EXT_PYTHON: the first python3 of the PATH that has NumPy, else any. Tests
# that need NumPy are skipped without it, visibly.
set(COLMAP_EXT_PYTHON python3)
string(REPLACE ":" ";" folders "$ENV{PATH}")
foreach(folder IN LISTS folders)
  execute_process(COMMAND ${folder}/python3 -c "import numpy"
    RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
  if(result STREQUAL "0")
    set(COLMAP_EXT_PYTHON ${folder}/python3)
    break()
  endif()
endforeach()
