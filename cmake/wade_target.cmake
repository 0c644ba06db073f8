# Compile options that every target of the project shares.
# -ffp-contract=off: the compiler may not fuse a*b+c differently from one loop to the next, so that the same
# scene gives the same bits whatever the number of threads and the processor. -fno-math-errno and -fno-trapping-math let loops with
# sqrt vectorise without changing a value.
add_library(wade_options INTERFACE)
target_compile_features(wade_options INTERFACE cxx_std_20)
target_compile_options(wade_options INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion
    -Wold-style-cast -Wcast-align -Wnon-virtual-dtor -Woverloaded-virtual -Wnull-dereference -Wduplicated-cond>
  -ffp-contract=off -fno-math-errno -fno-trapping-math)
# These are the same for all, too, so that all can share the compiled headers below.
target_compile_options(wade_options INTERFACE -fPIC $<$<COMPILE_LANGUAGE:CXX>:-fopenmp>)
target_compile_definitions(wade_options INTERFACE BOOST_ALL_NO_LIB)
if(WADE_WARNINGS_AS_ERRORS)
  target_compile_options(wade_options INTERFACE -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ 12 vectorises pairs of (double)(float)x in straight-line code and loses the rounding, so that clang has other bits
  # (tests/unit/configs/numbers/test_numbers.cpp). Loops still vectorise.
  target_compile_options(wade_options INTERFACE -fno-tree-slp-vectorize)
  # No collection of the compiler's own garbage below this heap, in kB, which a unity source just reaches: 5 % of its time.
  target_compile_options(wade_options INTERFACE --param=ggc-min-heapsize=524288)
endif()
if(WADE_NATIVE)
  target_compile_options(wade_options INTERFACE -march=native)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  # SSE4.2, of 2009 and later: the least that Highway has vectors for. The water's loops take more where there is more.
  target_compile_options(wade_options INTERFACE -march=x86-64-v2)
endif()
if(WADE_SANITIZE)
  target_compile_options(wade_options INTERFACE -fsanitize=${WADE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(wade_options INTERFACE -fsanitize=${WADE_SANITIZE})
endif()

# wade_headers(NAME [HEADER ...]): headers of the standard library that many sources read, and these, compiled once. Every
# source still includes what it uses, which clang-tidy sees, as it reads none of these. One set for all costs less than one with
# Eigen and one without.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/nothing.cpp CONTENT "")
function(wade_headers name)
  add_library(${name} STATIC ${PROJECT_BINARY_DIR}/nothing.cpp)
  target_link_libraries(${name} PRIVATE wade_options)
  target_precompile_headers(${name} PRIVATE <algorithm> <array> <chrono> <cmath> <cstdint> <cstring> <filesystem> <fstream>
    <functional> <iostream> <limits> <map> <memory> <optional> <set> <span> <sstream> <stdexcept> <string> <string_view>
    <utility> <variant> <vector> ${ARGN})
endfunction()
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
wade_headers(compiled_headers <Eigen/Core>)
target_link_libraries(compiled_headers PRIVATE Eigen3::Eigen)

# wade_doors(TARGET ENTRY ...): who links TARGET may include these headers, or all of the folder for ".", of the folder
# that calls, as "room/header.hpp" from the project's root. Nothing else is to be seen through this target, so that the
# compiler refuses an include that goes against the direction of the rooms.
function(wade_doors target)
  set(doors ${PROJECT_BINARY_DIR}/doors/${target})
  file(REMOVE_RECURSE ${doors})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  foreach(entry ${ARGN})
    cmake_path(SET link NORMALIZE ${doors}/${folder}/${entry})
    string(REGEX REPLACE "/$" "" link ${link})
    cmake_path(GET link PARENT_PATH parent)
    file(MAKE_DIRECTORY ${parent})
    file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR}/${entry} ${link} SYMBOLIC)
  endforeach()
  get_target_property(type ${target} TYPE)
  if(type STREQUAL INTERFACE_LIBRARY)
    target_include_directories(${target} INTERFACE $<BUILD_INTERFACE:${doors}>)
  else()
    target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${doors}>)
  endif()
endfunction()

# wade_room(NAME [IN FOLDER] [SOURCE ...] [DOORS HEADER ...] [USES ROOM ...]): a room of the product, a static library. It sees
# its own headers and those of the rooms that it uses, and of the rooms that these use. Sources lie in the folder, and without
# DOORS its headers are all of the folder's.
function(wade_room name)
  cmake_parse_arguments(room "" "IN" "DOORS;USES" ${ARGN})
  if(room_UNPARSED_ARGUMENTS)
    if(room_IN)
      list(TRANSFORM room_UNPARSED_ARGUMENTS REPLACE "^([^/].*)" "${room_IN}/\\1")
    endif()
    add_library(${name} STATIC ${room_UNPARSED_ARGUMENTS})
    target_link_libraries(${name} PUBLIC wade_options ${room_USES})
    target_precompile_headers(${name} REUSE_FROM compiled_headers)
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE wade_options ${room_USES})
  endif()
  if(NOT room_IN)
    set(room_IN .)
  endif()
  if(NOT room_DOORS)
    set(room_DOORS ${room_IN})
  endif()
  wade_doors(${name} ${room_DOORS})
endfunction()

# wade_compile_alone(SOURCE ...): sources of the calling folder that no unity source includes.
function(wade_compile_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# wade_library(NAME SOURCES ...): a static library of tools or tests, included from outside as "folder/header.hpp".
function(wade_library name)
  add_library(${name} STATIC ${ARGN})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC wade_options)
  target_precompile_headers(${name} REUSE_FROM compiled_headers)
endfunction()

# wade_program(NAME SOURCES ...): a program, placed at the top of the build folder.
function(wade_program name)
  add_executable(${name} ${ARGN})
  target_link_libraries(${name} PRIVATE wade_options)
  target_precompile_headers(${name} REUSE_FROM compiled_headers)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
endfunction()
