# Writes HEADER with the commit that is checked out in SOURCE, "+" where files differ from it. cmake -P.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git -C ${SOURCE} rev-parse --short=12 HEAD
  OUTPUT_VARIABLE COMMIT RESULT_VARIABLE FAILED OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(FAILED)
  set(COMMIT unknown)
else()
  execute_process(COMMAND git -C ${SOURCE} diff --quiet HEAD RESULT_VARIABLE CHANGED ERROR_QUIET)
  if(CHANGED)
    string(APPEND COMMIT +)
  endif()
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#define BIOPSY_COMMIT \"${COMMIT}\"\n")
