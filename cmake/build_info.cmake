# SPDX-License-Identifier: Apache-2.0
# Writes OUT, a header that says what is built: commit, whether the tree differs from it (RT_DIRTY) or is known not to
# (RT_CLEAN), compiler and flags. It runs at every build, and touches OUT only when something changed.
# cmake -DSOURCE=... -DOUT=... -DCOMPILER=... -DFLAGS=... -P build_info.cmake
set(commit "unknown")
set(dirty false)
set(clean false)
find_package(Git QUIET)
if(GIT_FOUND AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} rev-parse --short=12 HEAD
    OUTPUT_VARIABLE head OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(commit ${head})
    execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} status --porcelain --untracked-files=no
      OUTPUT_VARIABLE changes ERROR_QUIET)
    if(changes)
      set(dirty true)
    else()
      set(clean true)
    endif()
  endif()
elseif(EXISTS ${SOURCE}/cmake/commit.txt) # a source archive
  file(STRINGS ${SOURCE}/cmake/commit.txt line REGEX "^[0-9a-f]+$")
  if(line)
    string(SUBSTRING ${line} 0 12 commit)
  endif()
endif()
string(REGEX REPLACE " +-W[^ ]*" "" FLAGS "${FLAGS}") # warnings change no result
string(STRIP "${FLAGS}" FLAGS)
set(text "#define RT_COMMIT \"${commit}\"
#define RT_DIRTY ${dirty}
#define RT_CLEAN ${clean}
#define RT_COMPILER \"${COMPILER}\"
#define RT_FLAGS \"${FLAGS}\"
")
set(old "")
if(EXISTS ${OUT})
  file(READ ${OUT} old)
endif()
if(NOT old STREQUAL text)
  file(WRITE ${OUT} "${text}")
endif()
