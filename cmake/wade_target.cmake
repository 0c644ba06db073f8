# Compile options that every target of the project shares.
# -ffp-contract=off: the compiler may not fuse a*b+c differently from one loop to the next, so that the same
# scene gives the same bits whatever the number of threads. -fno-math-errno and -fno-trapping-math let loops with
# sqrt vectorise without changing a value.
add_library(wade_options INTERFACE)
target_compile_features(wade_options INTERFACE cxx_std_20)
target_compile_options(wade_options INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion
    -Wold-style-cast -Wcast-align -Wnon-virtual-dtor -Woverloaded-virtual -Wnull-dereference -Wduplicated-cond>
  -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(WADE_WARNINGS_AS_ERRORS)
  target_compile_options(wade_options INTERFACE -Werror)
endif()
if(WADE_NATIVE)
  target_compile_options(wade_options INTERFACE -march=native)
endif()
if(WADE_SANITIZE)
  target_compile_options(wade_options INTERFACE -fsanitize=${WADE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(wade_options INTERFACE -fsanitize=${WADE_SANITIZE})
endif()

# wade_library(NAME SOURCES ...): a static library of one room, included from outside as "room/header.hpp".
function(wade_library name)
  add_library(${name} STATIC ${ARGN})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC wade_options)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
endfunction()

# wade_program(NAME SOURCES ...): a program, placed at the top of the build folder.
function(wade_program name)
  add_executable(${name} ${ARGN})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE wade_options)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
endfunction()
