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

# biopsy_add_test(NAME SOURCES ... LINKS ... [LABEL label] [NO_UNITY]
#                 [ONE_PROCESS suite ...] [FULL pattern ...] [REAL_TIME pattern ...] [FULL_REAL_TIME pattern ...])
# One program of tests, build/PRESET/tests/test_NAME, in unity batches; each test is a process and an entry of ctest with
# the label NAME unless given. Patterns are Suite.* or Suite.Name:
#   ONE_PROCESS     the suite is one process and one entry, without its FULL tests: its tests share a costly result
#   FULL            of `./dev test --all` only: label NAME-full
#   REAL_TIME       nothing runs beside it; FULL_REAL_TIME: both
function(biopsy_add_test NAME)
  cmake_parse_arguments(ARG "NO_UNITY" "LABEL" "SOURCES;LINKS;ONE_PROCESS;FULL;REAL_TIME;FULL_REAL_TIME" ${ARGN})
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
  add_dependencies(tests test_${NAME})

  list(TRANSFORM ARG_ONE_PROCESS APPEND ".*" OUTPUT_VARIABLE SUITES)
  string(REPLACE ";" ":" OTHERS "${SUITES};${ARG_FULL};${ARG_REAL_TIME};${ARG_FULL_REAL_TIME}")
  biopsy_discover_tests(${NAME} PLAIN "*" "-${OTHERS}" ${ARG_LABEL})
  set(FULL ${ARG_FULL})
  list(REMOVE_ITEM FULL ${SUITES})
  string(REPLACE ";" ":" FULL "${FULL}")
  foreach(SUITE ${ARG_ONE_PROCESS})
    set(LABEL ${ARG_LABEL})
    if("${SUITE}.*" IN_LIST ARG_FULL)
      set(LABEL ${ARG_LABEL}-full)
    endif()
    add_test(NAME ${SUITE} COMMAND test_${NAME} --gtest_filter=${SUITE}.*-${FULL})
    set_tests_properties(${SUITE} PROPERTIES LABELS ${LABEL} TIMEOUT 600)
  endforeach()
  string(REPLACE ";" ":" REAL_TIME "${ARG_REAL_TIME}")
  string(REPLACE ";" ":" FULL_REAL_TIME "${ARG_FULL_REAL_TIME}")
  biopsy_discover_tests(${NAME} REAL_TIME "${REAL_TIME}" "" ${ARG_LABEL} RUN_SERIAL TRUE)
  biopsy_discover_tests(${NAME} FULL "${FULL}" "-${REAL_TIME}:${FULL_REAL_TIME}" ${ARG_LABEL}-full)
  biopsy_discover_tests(${NAME} FULL_REAL_TIME "${FULL_REAL_TIME}" "-${REAL_TIME}" ${ARG_LABEL}-full RUN_SERIAL TRUE)
endfunction()
function(biopsy_discover_tests NAME KIND WITH WITHOUT LABEL)  # an entry of ctest for each test; more properties behind
  if(WITH)
    gtest_discover_tests(test_${NAME} TEST_FILTER "${WITH}${WITHOUT}" TEST_LIST test_${NAME}_${KIND} DISCOVERY_TIMEOUT 60
      PROPERTIES LABELS ${LABEL} TIMEOUT 900 ${ARGN})
  endif()
endfunction()
add_custom_target(tests)  # every test program; benches and the proofs of the safety case are built with `all`
