# What `cmake --install` puts where, in the components that are packages of their own (Packages.cmake). The programs find
# share/biopsy beside their folder, wherever the whole was moved.
install(TARGETS biopsy COMPONENT program)
install(FILES ${CMAKE_BINARY_DIR}/completion/biopsy DESTINATION share/bash-completion/completions COMPONENT program)
foreach(FOLDER sim/models robot/procedure/cases safety/case docs/examples)
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/${FOLDER}/ DESTINATION share/biopsy/${FOLDER} COMPONENT program)
endforeach()

if(TARGET biopsy-mpi)
  install(TARGETS biopsy-mpi COMPONENT mpi)
endif()

install(TARGETS biopsy-interlock biopsy-supervisor biopsy-controller biopsy-stage biopsy-recorder COMPONENT live)
set(SYSTEMD ${CMAKE_SOURCE_DIR}/robot/live/systemd)
foreach(UNIT prepare interlock recorder supervisor stage controller)
  list(APPEND LIVE_UNITS ${SYSTEMD}/biopsy-${UNIT}.service)
endforeach()
install(FILES ${LIVE_UNITS} ${SYSTEMD}/biopsy.target DESTINATION lib/systemd/system COMPONENT live)
install(FILES ${SYSTEMD}/biopsy.sysusers DESTINATION lib/sysusers.d RENAME biopsy.conf COMPONENT live)
install(FILES ${SYSTEMD}/biopsy.tmpfiles DESTINATION lib/tmpfiles.d RENAME biopsy.conf COMPONENT live)

install(TARGETS biopsy-console biopsy-igtl biopsy-mcap biopsy-ros2 COMPONENT console)
foreach(UNIT console igtl mcap ros2)
  install(FILES ${SYSTEMD}/biopsy-${UNIT}.service DESTINATION lib/systemd/system COMPONENT console)
endforeach()
set(BUILT_PAGE ${CMAKE_BINARY_DIR}/console/page/dist)
install(CODE "if(NOT EXISTS ${BUILT_PAGE}/index.html)
    message(FATAL_ERROR \"the console's page is not built: ./dev build, or build the target console_page (needs npm);\"
                        \" or install the other components alone (--component program, --component live)\")
  endif()" COMPONENT console)
install(DIRECTORY ${BUILT_PAGE}/ DESTINATION share/biopsy/console/page COMPONENT console)

if(BIOPSY_PYTHON)
  set(PYTHON_FILES ${CMAKE_SOURCE_DIR}/robot/python/biopsy)
  install(TARGETS biopsy_python DESTINATION lib/python3/dist-packages/biopsy COMPONENT python)
  install(FILES ${PYTHON_FILES}/__init__.py ${PYTHON_FILES}/__init__.pyi ${PYTHON_FILES}/_errors.py ${PYTHON_FILES}/py.typed
          DESTINATION lib/python3/dist-packages/biopsy COMPONENT python)
endif()

# For other programs on the bus: the messages as IDL.
install(FILES ${CMAKE_BINARY_DIR}/generated/robot/msg/wire.idl DESTINATION share/idl/biopsy COMPONENT dev)

install(FILES ${CMAKE_SOURCE_DIR}/LICENSE ${CMAKE_SOURCE_DIR}/NOTICE DESTINATION share/doc/biopsy COMPONENT licence)
