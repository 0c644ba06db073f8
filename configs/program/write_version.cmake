# cmake -D SOURCE_DIR=... -D OUTPUT=... -D VERSION=... -D COMPILER=... -P write_version.cmake
# Writes the header with the version and the commit; leaves it untouched when nothing changed, so that nothing is rebuilt.
set(hash "unknown")
find_program(GIT_PROGRAM git)
if(GIT_PROGRAM)
  execute_process(COMMAND ${GIT_PROGRAM} --no-optional-locks rev-parse --short=12 HEAD
    WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE commit RESULT_VARIABLE failed
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed)
    set(hash "${commit}")
    execute_process(COMMAND ${GIT_PROGRAM} --no-optional-locks status --porcelain --untracked-files=no
      WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE changes ERROR_QUIET)
    if(changes)
      string(APPEND hash "-dirty")
    endif()
  endif()
endif()

set(text "#pragma once
// Written by configs/program/write_version.cmake at each build.
#define WADE_BUILD_VERSION \"${VERSION}\"
#define WADE_BUILD_GIT_HASH \"${hash}\"
#define WADE_BUILD_COMPILER \"${COMPILER}\"
")
set(before "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUTPUT} "${text}")
endif()
