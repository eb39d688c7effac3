# Finds the MATLAB file library libmatio (Debian: libmatio-dev), which ships no CMake package.
find_path(MatIO_INCLUDE_DIR matio.h)
find_library(MatIO_LIBRARY matio)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MatIO REQUIRED_VARS MatIO_LIBRARY MatIO_INCLUDE_DIR)
if(MatIO_FOUND AND NOT TARGET MatIO::MatIO)
  add_library(MatIO::MatIO UNKNOWN IMPORTED)
  set_target_properties(MatIO::MatIO PROPERTIES
    IMPORTED_LOCATION "${MatIO_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${MatIO_INCLUDE_DIR}")
endif()
mark_as_advanced(MatIO_INCLUDE_DIR MatIO_LIBRARY)
