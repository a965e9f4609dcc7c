# Debian packages by CPack, one a component: `./dev package`, or cpack in build/release. What only a package has is left out of
# a plain `cmake --install` (EXCLUDE_FROM_ALL).
set(BIOPSY_MAINTAINER "biopsy maintainers <maintainers@users.noreply.github.com>" CACHE STRING "of the packages: Name <address>")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "${BIOPSY_MAINTAINER}")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program live console dev)
if(BIOPSY_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
if(TARGET biopsy-mpi)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
endif()
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(SAME_VERSION "(= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
set(WARNING "This software has not run on real hardware and is not approved for use on\npatients.")
# biopsy_package(COMPONENT NAME SUMMARY DEPENDS TEXT)
function(biopsy_package COMPONENT NAME SUMMARY DEPENDS TEXT)
  string(TOUPPER ${COMPONENT} UPPER)
  set(CPACK_DEBIAN_${UPPER}_PACKAGE_NAME ${NAME} PARENT_SCOPE)
  set(CPACK_DEBIAN_${UPPER}_PACKAGE_DEPENDS "${DEPENDS}" PARENT_SCOPE)
  set(CPACK_COMPONENT_${UPPER}_DESCRIPTION "${SUMMARY}\n${TEXT}\n${WARNING}" PARENT_SCOPE)
  set(DOC share/doc/${NAME})
  install(FILES ${CMAKE_SOURCE_DIR}/cmake/packages/copyright DESTINATION ${DOC} COMPONENT ${COMPONENT} EXCLUDE_FROM_ALL)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/packages/${NAME}/changelog @ONLY
       CONTENT "${NAME} (${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium\n
  * See CHANGELOG.md of the sources.\n\n -- ${BIOPSY_MAINTAINER}  ${BIOPSY_PACKAGE_DATE}\n")
  install(CODE "execute_process(COMMAND gzip -9nc ${CMAKE_BINARY_DIR}/packages/${NAME}/changelog
    OUTPUT_FILE ${CMAKE_BINARY_DIR}/packages/${NAME}/changelog.Debian.gz COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${COMPONENT} EXCLUDE_FROM_ALL)
  install(FILES ${CMAKE_BINARY_DIR}/packages/${NAME}/changelog.Debian.gz DESTINATION ${DOC} COMPONENT ${COMPONENT} EXCLUDE_FROM_ALL)
endfunction()
# Of the commit, not of the day: the same sources give the same package.
execute_process(COMMAND git -C ${CMAKE_SOURCE_DIR} log -1 --format=%cD OUTPUT_VARIABLE BIOPSY_PACKAGE_DATE
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)

biopsy_package(program biopsy "MRI-safe needle biopsy robot: planner, rehearsal, gap search" ""
"Plans a needle biopsy on MR images, rehearses it on a simulated
electrohydraulic stage under the safety supervisor, checks the needle's depth
from images, and finds what the simulation model lacks from measured runs.")
biopsy_package(live biopsy-live "MRI-safe needle biopsy robot: real-time processes" "biopsy ${SAME_VERSION}, systemd"
"Interlock, recorder, supervisor, stage and controller as processes of their
own on a secured DDS bus, and their systemd units. Nothing is started or
enabled at installation. Procedure logs and keys are kept at upgrade and
removal.")
biopsy_package(console biopsy-console "MRI-safe needle biopsy robot: clinician's page" "biopsy-live ${SAME_VERSION}"
"Serves the page on which a clinician picks the target, arms, inserts step by
step and confirms the depth, in a browser on the same machine.")
biopsy_package(dev biopsy-dev "MRI-safe needle biopsy robot: libraries and messages"
"libeigen3-dev, libopencv-core-dev, libopencv-imgproc-dev, libdcmtk-dev, libopenjp2-7-dev, libnifti-dev, libpng-dev, zlib1g-dev, libssl-dev, libtbb-dev, libceres-dev, libfmt-dev, libspdlog-dev, libtomlplusplus-dev, nlohmann-json3-dev"
"What other programs are built with (find_package(biopsy)): messages, safety,\nplanner, images, simulation and gap search; and the bus messages as OMG IDL.")

if(TARGET biopsy-mpi)
  biopsy_package(mpi biopsy-mpi "MRI-safe needle biopsy robot: campaigns on many machines" "biopsy ${SAME_VERSION}, openmpi-bin"
"Runs the rehearsals of a campaign on the ranks of an MPI job.")
endif()

if(BIOPSY_PYTHON)
  math(EXPR NEXT_MINOR "${Python3_VERSION_MINOR} + 1")
  biopsy_package(python python3-biopsy "MRI-safe needle biopsy robot: Python package"
"biopsy ${SAME_VERSION}, python3-numpy, python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}), python3 (<< ${Python3_VERSION_MAJOR}.${NEXT_MINOR})"
"Plant, gap search, depth check, plans, rehearsals and the control cycle on\nnumpy arrays.")
  set(BYTECODE ${CMAKE_SOURCE_DIR}/cmake/packages/python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${BYTECODE}/postinst ${BYTECODE}/prerm)
endif()

set(SCRIPTS ${CMAKE_SOURCE_DIR}/cmake/packages/live)
set(CPACK_DEBIAN_LIVE_PACKAGE_CONTROL_EXTRA ${SCRIPTS}/postinst ${SCRIPTS}/prerm ${SCRIPTS}/postrm)
set(CPACK_DEBIAN_CONSOLE_PACKAGE_CONTROL_EXTRA ${SCRIPTS}/prerm)

install(CODE "execute_process(COMMAND ${CMAKE_SOURCE_DIR}/cmake/packages/sbom ${CMAKE_BINARY_DIR} ${PROJECT_VERSION}
  COMMAND_ERROR_IS_FATAL ANY)" COMPONENT program EXCLUDE_FROM_ALL)
install(FILES ${CMAKE_BINARY_DIR}/packages/biopsy.cdx.json ${CMAKE_BINARY_DIR}/packages/biopsy.spdx.json
        DESTINATION share/doc/biopsy COMPONENT program EXCLUDE_FROM_ALL)
include(CPack)
