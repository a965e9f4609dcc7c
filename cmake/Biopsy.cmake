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

# biopsy_add_test(NAME SOURCES ... LINKS ... [LABEL label] [SERIAL])
# One program of tests, build/PRESET/tests/test_NAME; its label is NAME unless given. SERIAL: in real time, alone on the
# machine.
function(biopsy_add_test NAME)
  cmake_parse_arguments(ARG "SERIAL" "LABEL" "SOURCES;LINKS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL ${NAME})
  endif()
  add_executable(test_${NAME} ${ARG_SOURCES})
  set_target_properties(test_${NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(test_${NAME} PRIVATE ${ARG_LINKS} source_dir GTest::gtest GTest::gtest_main)
  target_compile_options(test_${NAME} PRIVATE ${BIOPSY_TEST_OPTIONS})
  target_precompile_headers(test_${NAME} REUSE_FROM heavy_test_headers)
  set(SERIAL "")
  if(ARG_SERIAL)
    set(SERIAL RUN_SERIAL TRUE)
  endif()
  gtest_discover_tests(test_${NAME} TEST_FILTER "-GapExample.*:Document.*/live" DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ${ARG_LABEL} TIMEOUT 600 ${SERIAL})
endfunction()
