# find_package(biopsy): what programs outside of this tree can use. docs/how-to/use-from-cpp.md says what of it is public.
include(CMakePackageConfigHelpers)

set(BIOPSY_EXPORTED common parallel msg safety control planner imaging drivers sim gap)
set(WITHIN digests simulated_stage scanner dense_ceres without_suitesparse)  # of which those are made
set_target_properties(msg PROPERTIES EXPORT_NAME messages)
foreach(TARGET common parallel)  # every other is linked with one of them
  target_include_directories(${TARGET} INTERFACE $<INSTALL_INTERFACE:include/biopsy>)
  target_compile_features(${TARGET} INTERFACE cxx_std_20)
endforeach()

install(TARGETS ${BIOPSY_EXPORTED} ${WITHIN} EXPORT biopsyTargets
  ARCHIVE DESTINATION lib/biopsy COMPONENT dev)
foreach(FOLDER robot/common robot/msg robot/control safety planner drivers sim)
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/${FOLDER}/ DESTINATION include/biopsy/${FOLDER} COMPONENT dev
    FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(DIRECTORY ${CMAKE_BINARY_DIR}/generated/robot/msg/ DESTINATION include/biopsy/robot/msg COMPONENT dev
  FILES_MATCHING REGEX "/(fixed_)?messages.hpp$")

set(PACKAGE lib/cmake/biopsy)
install(EXPORT biopsyTargets NAMESPACE biopsy:: DESTINATION ${PACKAGE} COMPONENT dev)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/biopsyConfig.cmake.in ${CMAKE_BINARY_DIR}/package/biopsyConfig.cmake
  INSTALL_DESTINATION ${PACKAGE})
# Semantic versions: before 1.0 a new minor version may change what is public.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/biopsyConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${CMAKE_BINARY_DIR}/package/biopsyConfig.cmake
  ${CMAKE_BINARY_DIR}/package/biopsyConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindOpenCVParts.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindDcmtkParts.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindOpenJpeg.cmake
  DESTINATION ${PACKAGE} COMPONENT dev)
