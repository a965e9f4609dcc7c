# How this project's libraries, programs and tests are declared.

# Headers that take longest to parse, precompiled. No source may rely on it: the lint reads every file without.
set(BIOPSY_HEAVY_HEADERS <Eigen/Geometry> <fmt/format.h> <nlohmann/json.hpp> <algorithm> <chrono> <filesystem> <fstream>
    <functional> <map> <memory> <optional> <string> <variant> <vector>)
function(biopsy_add_precompiled_headers NAME LINKS)  # (NAME LINKS HEADER ...): for REUSE_FROM
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/${NAME}.cpp CONTENT "")
  add_library(${NAME} STATIC ${CMAKE_BINARY_DIR}/${NAME}.cpp)
  target_link_libraries(${NAME} PRIVATE ${LINKS})
  target_precompile_headers(${NAME} PRIVATE ${ARGN})
endfunction()

# biopsy_add_library(NAME SOURCES ... LINKS ... [NO_UNITY] [NO_PRECOMPILED_HEADERS])
# Sources are compiled in unity batches, which halves the build; NO_UNITY where unnamed namespaces share names.
function(biopsy_add_library NAME)
  cmake_parse_arguments(ARG "NO_UNITY;NO_PRECOMPILED_HEADERS" "" "SOURCES;LINKS" ${ARGN})
  if(NOT ARG_SOURCES)
    add_library(${NAME} INTERFACE)
    target_link_libraries(${NAME} INTERFACE ${ARG_LINKS})
    return()
  endif()
  add_library(${NAME} STATIC ${ARG_SOURCES})
  target_link_libraries(${NAME} PUBLIC ${ARG_LINKS})
  if(NOT ARG_NO_PRECOMPILED_HEADERS)
    target_precompile_headers(${NAME} REUSE_FROM heavy_headers)
  endif()
  if(NOT ARG_NO_UNITY)
    set_target_properties(${NAME} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  endif()
endfunction()

# biopsy_add_test(NAME SOURCES ... LINKS ... [LABEL label] [SERIAL] [NO_UNITY]
#                 [TOGETHER suite ...] [FULL pattern ...] [ALONE pattern ...])
# One program of tests, build/PRESET/tests/test_NAME, in unity batches; each test is a process and an entry of ctest with
# the label NAME unless given. TOGETHER: a suite is one process and one entry, for tests that share a costly result.
# FULL: tests (Suite.* or Suite.Name) of `./dev test --all` only, label NAME-full. ALONE: tests in real time, with nothing
# beside them; SERIAL: all of them.
function(biopsy_add_test NAME)
  cmake_parse_arguments(ARG "SERIAL;NO_UNITY" "LABEL" "SOURCES;LINKS;TOGETHER;FULL;ALONE" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL ${NAME})
  endif()
  add_executable(test_${NAME} ${ARG_SOURCES})
  set_target_properties(test_${NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  if(NOT ARG_NO_UNITY)
    set_target_properties(test_${NAME} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 14)
  endif()
  target_link_libraries(test_${NAME} PRIVATE ${ARG_LINKS} source_dir GTest::gtest GTest::gtest_main)
  target_compile_options(test_${NAME} PRIVATE ${BIOPSY_TEST_OPTIONS})
  target_precompile_headers(test_${NAME} REUSE_FROM heavy_test_headers)

  set(SERIAL "")
  if(ARG_SERIAL)
    set(SERIAL RUN_SERIAL TRUE)
  endif()
  list(TRANSFORM ARG_TOGETHER APPEND ".*" OUTPUT_VARIABLE SUITES)
  string(REPLACE ";" ":" ELSEWHERE "${SUITES};${ARG_FULL};${ARG_ALONE}")
  gtest_discover_tests(test_${NAME} TEST_FILTER "-${ELSEWHERE}" DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ${ARG_LABEL} TIMEOUT 600 ${SERIAL})
  foreach(SUITE ${ARG_TOGETHER})
    set(LABEL ${ARG_LABEL})
    if("${SUITE}.*" IN_LIST ARG_FULL)
      set(LABEL ${ARG_LABEL}-full)
    endif()
    add_test(NAME ${SUITE} COMMAND test_${NAME} --gtest_filter=${SUITE}.*)
    set_tests_properties(${SUITE} PROPERTIES LABELS ${LABEL} TIMEOUT 600 ${SERIAL}
      SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
  endforeach()
  list(REMOVE_ITEM ARG_FULL ${SUITES})
  if(ARG_FULL)
    string(REPLACE ";" ":" FULL "${ARG_FULL}")
    gtest_discover_tests(test_${NAME} TEST_FILTER "${FULL}" TEST_LIST test_${NAME}_FULL DISCOVERY_TIMEOUT 60
      PROPERTIES LABELS ${ARG_LABEL}-full TIMEOUT 600 ${SERIAL})
  endif()
  if(ARG_ALONE)
    string(REPLACE ";" ":" ALONE "${ARG_ALONE}")
    gtest_discover_tests(test_${NAME} TEST_FILTER "${ALONE}" TEST_LIST test_${NAME}_ALONE DISCOVERY_TIMEOUT 60
      PROPERTIES LABELS ${ARG_LABEL} TIMEOUT 600 RUN_SERIAL TRUE)
  endif()
endfunction()
