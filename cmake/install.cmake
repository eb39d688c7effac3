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
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")

install(EXPORT posewiseTargets NAMESPACE posewise:: DESTINATION "${package_directory}")
configure_package_config_file(cmake/posewiseConfig.cmake.in posewiseConfig.cmake
  INSTALL_DESTINATION "${package_directory}")
write_basic_package_version_file(posewiseConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/posewiseConfig.cmake"
  "${PROJECT_BINARY_DIR}/posewiseConfigVersion.cmake" cmake/FindMatIO.cmake
  DESTINATION "${package_directory}")
