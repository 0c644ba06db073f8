# wade_optional(RESULT LEFT_OUT REMEDY [HEADER FILE] COMMAND WORD ...): sets RESULT to true if the command succeeds. Else tells in
# one line what is left out, why, and how to get it. With HEADER the command ends with a source that includes this file.
#
# Packages can be there in part: a compiler wrapper without headers, headers without library. Targets that find_package and
# pkg_check_modules make of such a package stop CMake or the build, so that they may only be used after this test.
function(wade_optional result left_out remedy)
  cmake_parse_arguments(PARSE_ARGV 3 arg "" HEADER COMMAND)
  set(folder ${PROJECT_BINARY_DIR}/optional)
  if(arg_HEADER)
    file(CONFIGURE OUTPUT ${folder}/${result}.c CONTENT "#include <${arg_HEADER}>\nint main(void) { return 0; }\n")
    list(APPEND arg_COMMAND ${folder}/${result}.c -o ${folder}/${result})
  endif()
  execute_process(COMMAND ${arg_COMMAND} RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(code EQUAL 0)
    set(${result} TRUE PARENT_SCOPE)
    return()
  endif()
  set(${result} FALSE PARENT_SCOPE)
  list(GET arg_COMMAND 0 program)
  if(program MATCHES "NOTFOUND$")
    set(reason "it is not installed")
  elseif(said MATCHES "(error: |cannot find )([^\n]*)")
    string(REPLACE "error: " "" reason "${CMAKE_MATCH_0}")
  else()
    set(reason "${program} fails with ${code}")
  endif()
  message(STATUS "Left out: ${left_out} (${reason}); ${remedy}")
endfunction()
