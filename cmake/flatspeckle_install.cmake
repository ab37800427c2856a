# The package: find_package(flatspeckle) gives the modules as flatspeckle::core and so on. Modules and the program
# install themselves; this file installs the shared files.
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

install(DIRECTORY plots octave data/scenes data/pictures DESTINATION ${CMAKE_INSTALL_DATADIR}/flatspeckle
        PATTERN __pycache__ EXCLUDE)
if(FLATSPECKLE_BENCH)  # plots/report.py writes the pages of bench results
  install(DIRECTORY scripts/report_pages DESTINATION ${CMAKE_INSTALL_DATADIR}/flatspeckle/scripts
          PATTERN __pycache__ EXCLUDE)
endif()
# Debian's folder for Python 3 packages; with another prefix, add it to PYTHONPATH.
set(FLATSPECKLE_PYTHON_DIR lib/python3/dist-packages CACHE STRING "Where the Python package goes, under the prefix")
install(DIRECTORY python/flatspeckle DESTINATION ${FLATSPECKLE_PYTHON_DIR} PATTERN __pycache__ EXCLUDE)
# The program generates these files from its keys.
install(CODE "execute_process(COMMAND $<TARGET_FILE:flatspeckle> keys man
                              OUTPUT_FILE ${PROJECT_BINARY_DIR}/flatspeckle.1 COMMAND_ERROR_IS_FATAL ANY)
              execute_process(COMMAND $<TARGET_FILE:flatspeckle> keys completion
                              OUTPUT_FILE ${PROJECT_BINARY_DIR}/flatspeckle.bash COMMAND_ERROR_IS_FATAL ANY)
              execute_process(COMMAND $<TARGET_FILE:flatspeckle> keys zsh
                              OUTPUT_FILE ${PROJECT_BINARY_DIR}/flatspeckle.zsh COMMAND_ERROR_IS_FATAL ANY)")
install(FILES ${PROJECT_BINARY_DIR}/flatspeckle.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${PROJECT_BINARY_DIR}/flatspeckle.bash RENAME flatspeckle
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${PROJECT_BINARY_DIR}/flatspeckle.zsh RENAME _flatspeckle
        DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(FILES LICENSE CITATION.cff CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

# cpack builds a package for the Debian release that it runs on.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The flatspeckle developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "python3 (>= 3.11), python3-h5py, python3-xarray, python3-matplotlib")
include(CPack)
