# Finds the MATLAB file library libmatio (Debian: libmatio-dev), which ships no CMake package.
find_path(MatIO_INCLUDE_DIR matio.h)
find_library(MatIO_LIBRARY matio)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MatIO REQUIRED_VARS MatIO_LIBRARY MatIO_INCLUDE_DIR)
if(MatIO_FOUND AND NOT TARGET MatIO::MatIO)
  # MatIO_FILE is its name at run time, libmatio.so.11: it is loaded when a MATLAB file is.
  get_filename_component(MatIO_FILE "${MatIO_LIBRARY}" REALPATH)
  string(REGEX REPLACE "^.*/(libmatio\\.so\\.[0-9]+)[^/]*$" "\\1" MatIO_FILE "${MatIO_FILE}")
  add_library(MatIO::MatIO INTERFACE IMPORTED)
  set_target_properties(MatIO::MatIO PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${MatIO_INCLUDE_DIR}")
endif()
mark_as_advanced(MatIO_INCLUDE_DIR MatIO_LIBRARY)
