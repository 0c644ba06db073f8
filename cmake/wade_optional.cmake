# Optional parts. Packages can be there in part: a compiler wrapper without headers, headers without library, a package file
# that includes a missing one. find_package, pkg_check_modules and the targets that they make then stop CMake or the build.
# So each part is first used in a process of its own, and is left out with one line where that fails.

# wade_left_out(LEFT_OUT REMEDY PROGRAM CODE SAID): tells what is left out, why, and how to get it.
function(wade_left_out left_out remedy program code said)
  string(REGEX REPLACE "[ \n]+" " " said "${said}")
  string(REGEX REPLACE " (\\||CMake Error at|Call Stack|Reason given|Possible reasons|compilation term|collect2:).*" "" said "${said}")
  if(program MATCHES "NOTFOUND$")
    set(reason "it is not installed")
  elseif(said MATCHES "(([^ ]*: No such file|cannot find |[Cc]ould not find |Could NOT find |non-existent path).*)")
    string(SUBSTRING "${CMAKE_MATCH_1}" 0 160 reason)
  else()
    set(reason "${program} fails with ${code}")
  endif()
  message(STATUS "Left out: ${left_out} (${reason}); ${remedy}")
endfunction()

# wade_optional(RESULT LEFT_OUT REMEDY [HEADER FILE] [MAKES FILE] COMMAND WORD ...): sets RESULT to true if the command succeeds
# and makes the file. With HEADER the command ends with a source that includes this file.
function(wade_optional result left_out remedy)
  cmake_parse_arguments(PARSE_ARGV 3 arg "" "HEADER;MAKES" COMMAND)
  set(folder ${PROJECT_BINARY_DIR}/optional)
  file(MAKE_DIRECTORY ${folder})
  if(arg_HEADER)
    set(arg_MAKES ${folder}/${result})
    file(CONFIGURE OUTPUT ${folder}/${result}.c CONTENT "#include <${arg_HEADER}>\nint main(void) { return 0; }\n")
    list(APPEND arg_COMMAND ${folder}/${result}.c -o ${folder}/${result})
  endif()
  if(arg_MAKES)
    file(REMOVE ${arg_MAKES})
  endif()
  execute_process(COMMAND ${arg_COMMAND} RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE said TIMEOUT 60)
  set(${result} FALSE PARENT_SCOPE)
  list(GET arg_COMMAND 0 program)
  if(NOT code EQUAL 0)
    wade_left_out("${left_out}" "${remedy}" "${program}" "${code}" "${said}")
  elseif(arg_MAKES AND NOT EXISTS ${arg_MAKES})
    wade_left_out("${left_out}" "${remedy}" "${program}" "no output" "")
  else()
    set(${result} TRUE PARENT_SCOPE)
  endif()
endfunction()

# wade_optional_package(RESULT LEFT_OUT REMEDY FIND TARGETS HEADER): sets RESULT to true, and carries out FIND, lines of CMake
# that find a package, if a small project by the same lines builds a program with this header and these targets.
macro(wade_optional_package result left_out remedy find targets header)
  wade_try_package(${result} "${left_out}" "${remedy}" "${find}" "${targets}" "${header}")
  if(${result})
    cmake_language(EVAL CODE "${find}")
  endif()
endmacro()

function(wade_try_package result left_out remedy find targets header)
  set(folder ${PROJECT_BINARY_DIR}/optional/${result}_package)
  file(MAKE_DIRECTORY ${folder})
  file(CONFIGURE OUTPUT ${folder}/main.cpp CONTENT "#include <${header}>\nint main() { return 0; }\n")
  file(CONFIGURE OUTPUT ${folder}/CMakeLists.txt CONTENT "cmake_minimum_required(VERSION 3.25)
project(part LANGUAGES CXX)
${find}
add_executable(part main.cpp)
target_link_libraries(part PRIVATE ${targets})
")
  # What the user chose in this project counts in that one.
  set(options)
  get_cmake_property(names CACHE_VARIABLES)
  list(FILTER names INCLUDE REGEX
    "^CMAKE_(CXX_COMPILER|CXX_FLAGS|PREFIX_PATH|TOOLCHAIN_FILE|DISABLE_FIND_PACKAGE_.*)$|^MPI_CXX_COMPILER$|^[A-Za-z0-9]+_DIR$")
  foreach(name IN LISTS names)
    string(REPLACE ";" "\\;" value "${${name}}")
    list(APPEND options "-D${name}=${value}")
  endforeach()
  execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja ${options} -Wno-dev -S ${folder} -B ${folder}/build
    TIMEOUT 180 RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(code EQUAL 0)
    execute_process(COMMAND ${CMAKE_COMMAND} --build ${folder}/build
      TIMEOUT 180 RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE said)
  endif()
  if(code EQUAL 0)
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
    wade_left_out("${left_out}" "${remedy}" "it" "${code}" "${said}")
  endif()
endfunction()
