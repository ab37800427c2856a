# This script runs at every build: cmake -DSOURCE_DIR= -DVERSION= -DINPUT= -DOUTPUT= [-DGIT=] -P git_commit.cmake
# Writes OUTPUT from INPUT with the checkout's commit; an unchanged OUTPUT is not rewritten.
set(COMMIT unknown)
if(GIT)
  # Also works in a checkout owned by another user, as in a container.
  set(GIT ${GIT} -c safe.directory=${SOURCE_DIR})
  # An empty prefix means that SOURCE_DIR is the top of a checkout, not a copy inside another one.
  execute_process(COMMAND ${GIT} rev-parse --show-prefix WORKING_DIRECTORY ${SOURCE_DIR}
                  OUTPUT_VARIABLE prefix RESULT_VARIABLE outside ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  execute_process(COMMAND ${GIT} rev-parse --verify HEAD WORKING_DIRECTORY ${SOURCE_DIR}
                  OUTPUT_VARIABLE head RESULT_VARIABLE no_commit ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT outside AND NOT no_commit AND prefix STREQUAL "")
    execute_process(COMMAND ${GIT} status --porcelain --untracked-files=no
                    WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE changes ERROR_QUIET)
    set(COMMIT ${head})
    if(changes)
      string(APPEND COMMIT "+changes")
    endif()
  endif()
endif()
configure_file(${INPUT} ${OUTPUT} @ONLY)
