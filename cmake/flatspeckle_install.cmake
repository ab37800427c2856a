# The package: find_package(flatspeckle) gives the rooms as flatspeckle::core and so on. Rooms and the
# program install themselves; here is what belongs to all of them.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/flatspeckle)

configure_package_config_file(cmake/flatspeckle-config.cmake.in flatspeckle-config.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(flatspeckle-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/flatspeckle-config.cmake
              ${PROJECT_BINARY_DIR}/flatspeckle-config-version.cmake
              cmake/FindRandom123.cmake
        DESTINATION ${package_dir})
install(EXPORT flatspeckle NAMESPACE flatspeckle:: FILE flatspeckle-targets.cmake
        DESTINATION ${package_dir})

install(DIRECTORY plots data/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/flatspeckle
        PATTERN __pycache__ EXCLUDE)
# Debian's own place for packages of python3; under another prefix PYTHONPATH names it.
set(FLATSPECKLE_PYTHON_DIR lib/python3/dist-packages CACHE STRING "Where the Python package goes, under the prefix")
install(DIRECTORY python/flatspeckle DESTINATION ${FLATSPECKLE_PYTHON_DIR} PATTERN __pycache__ EXCLUDE)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
