# Installs the library, its headers and the program, and a package for find_package(posewise).
include(CMakePackageConfigHelpers)
set(package_directory "${CMAKE_INSTALL_LIBDIR}/cmake/posewise")

install(TARGETS posewise EXPORT posewiseTargets)
install(TARGETS posewise_program)
if(TARGET posewise_mpi)
  install(TARGETS posewise_mpi DESTINATION "${CMAKE_INSTALL_LIBEXECDIR}")
endif()
install(DIRECTORY include/posewise "${PROJECT_BINARY_DIR}/include/posewise"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "*.hpp")
install(FILES LICENSE README.md CHANGELOG.md DESTINATION "${CMAKE_INSTALL_DOCDIR}")

# The man page and what completes commands, as the program prints them.
add_custom_command(OUTPUT posewise.1 posewise.bash
  COMMAND posewise_program help --man > posewise.1
  COMMAND posewise_program completion bash > posewise.bash
  DEPENDS posewise_program VERBATIM)
add_custom_target(posewise_shell ALL DEPENDS posewise.1 posewise.bash)
install(FILES "${PROJECT_BINARY_DIR}/posewise.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
install(FILES "${PROJECT_BINARY_DIR}/posewise.bash" RENAME posewise
  DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions")

install(EXPORT posewiseTargets NAMESPACE posewise:: DESTINATION "${package_directory}")
configure_package_config_file(cmake/posewiseConfig.cmake.in posewiseConfig.cmake
  INSTALL_DESTINATION "${package_directory}")
write_basic_package_version_file(posewiseConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/posewiseConfig.cmake"
  "${PROJECT_BINARY_DIR}/posewiseConfigVersion.cmake" cmake/FindMinizip.cmake
  DESTINATION "${package_directory}")

# cpack -G DEB makes a package for Debian and Ubuntu of what is built.
if(PROJECT_IS_TOP_LEVEL)
  set(CPACK_PACKAGE_CONTACT "The posewise developers")
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Which poses to measure when a robot is calibrated")
  set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
  set(CPACK_DEBIAN_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
  if(MatIO_FILE MATCHES "libmatio\\.so\\.([0-9]+)")  # loaded when it is needed: not seen as linked
    set(CPACK_DEBIAN_PACKAGE_DEPENDS "libmatio${CMAKE_MATCH_1}")
  endif()
  include(CPack)
endif()
