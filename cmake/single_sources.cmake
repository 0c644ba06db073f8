# A second build folder, single_sources, that is configured only: without unity sources and precompiled headers. Its
# compile_commands.json, which has an entry for each source, is the one that editors and the checks of tests/checks read, and
# building it shows that each file includes what it uses. It takes 2 s, which CMAKE_EXPORT_COMPILE_COMMANDS=OFF saves.
if(NOT CMAKE_UNITY_BUILD OR NOT CMAKE_EXPORT_COMPILE_COMMANDS)
  return()
endif()

set(wade_single_sources ${PROJECT_BINARY_DIR}/single_sources)
set(kept)
foreach(name CMAKE_BUILD_TYPE CMAKE_C_COMPILER CMAKE_CXX_COMPILER CMAKE_CXX_COMPILER_LAUNCHER CMAKE_CXX_FLAGS
    CMAKE_CXX_FLAGS_DEBUG CMAKE_CXX_FLAGS_RELEASE CMAKE_PREFIX_PATH WADE_BUILD_TESTS WADE_NATIVE WADE_SANITIZE
    WADE_WARNINGS_AS_ERRORS)
  if(DEFINED ${name})
    string(REPLACE ";" "\\;" value "${${name}}")
    list(APPEND kept "-D${name}=${value}")
  endif()
endforeach()
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${PROJECT_SOURCE_DIR} -B ${wade_single_sources} -G ${CMAKE_GENERATOR} ${kept}
    -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DCMAKE_UNITY_BUILD=OFF
    -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(
  COMMAND ${CMAKE_COMMAND} --build ${wade_single_sources} --target wade_build_version
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(CREATE_LINK ${wade_single_sources}/compile_commands.json ${PROJECT_BINARY_DIR}/compile_commands.json SYMBOLIC)
set(CMAKE_EXPORT_COMPILE_COMMANDS OFF)
