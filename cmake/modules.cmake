set(posewise_slow_headers <Eigen/Dense> <algorithm> <cmath> <fmt/format.h> <functional> <map>
  <memory> <optional> <string> <vector>)

# Threads are ours (over candidates, starts, cases); Eigen's own would make sums depend on them. For
# all that is compiled here; what users of the library compile is theirs to decide.
set(posewise_definitions EIGEN_DONT_PARALLELIZE)

# Multiplication and addition are not fused: the same digits on CPUs that can and those that cannot.
# Nobody reads errno after a square root, which keeps them from being taken several at once.
set(posewise_options -ffp-contract=off -fno-math-errno)
# Code for a shared library is inlined as for a program: nobody replaces single functions of it.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND posewise_options -fno-semantic-interposition)
endif()

# posewise_module(<name> <modules it may use>...)
# An object library of all of src/<name>. Modules compile against the whole include tree; that they
# include only what they may is tested (tests/layering_test.py), and each module's tests link only
# the module and those it may use.
function(posewise_module name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/${name}/*.cpp")
  add_library(posewise_${name} OBJECT ${sources})
  target_include_directories(posewise_${name} PUBLIC
    "${PROJECT_SOURCE_DIR}/include" "${PROJECT_BINARY_DIR}/include")
  target_link_libraries(posewise_${name}
    PUBLIC Eigen3::Eigen
    PRIVATE posewise_warnings OpenMP::OpenMP_CXX yaml-cpp nlohmann_json::nlohmann_json fmt::fmt
      MatIO::MatIO)
  target_compile_definitions(posewise_${name} PRIVATE ${posewise_definitions})
  target_compile_options(posewise_${name} PRIVATE ${posewise_options})
  set_target_properties(posewise_${name} PROPERTIES
    UNITY_BUILD ${POSEWISE_UNITY_BUILD} UNITY_BUILD_BATCH_SIZE 10
    POSITION_INDEPENDENT_CODE ON)  # the Python module is a shared library
  # What takes a compiler longest to read, precompiled once for all modules, and once more with the
  # formats of files. That files include what they need is seen by the check of the headers.
  if(name STREQUAL "core")
    target_precompile_headers(posewise_core PRIVATE ${posewise_slow_headers})
  elseif(name STREQUAL "io")
    target_precompile_headers(posewise_io PRIVATE ${posewise_slow_headers}
      <nlohmann/json.hpp> <yaml-cpp/yaml.h>)
  else()
    target_precompile_headers(posewise_${name} REUSE_FROM posewise_core)
  endif()
  set_property(GLOBAL APPEND PROPERTY posewise_modules ${name})
  set_property(GLOBAL PROPERTY posewise_uses_${name} ${name} ${ARGN})
endfunction()

# Where nothing is computed a compiler is thrice as quick at -O1. No product of matrices may be there:
# of the copies of a template that objects bring along a linker takes the first, for all.
function(posewise_computes_nothing target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  set_property(GLOBAL APPEND PROPERTY posewise_without_products ${target})
endfunction()

# The one library people link: posewise::posewise, all modules together.
function(posewise_library)
  get_property(modules GLOBAL PROPERTY posewise_modules)
  add_library(posewise)
  add_library(posewise::posewise ALIAS posewise)
  foreach(module ${modules})
    target_sources(posewise PRIVATE $<TARGET_OBJECTS:posewise_${module}>)
  endforeach()
  target_include_directories(posewise PUBLIC
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>"
    "$<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>"
    "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
  target_link_libraries(posewise
    PUBLIC Eigen3::Eigen
    PRIVATE OpenMP::OpenMP_CXX yaml-cpp fmt::fmt NLopt::nlopt pugixml::pugixml
      SQLite::SQLite3 Minizip::Minizip ${CMAKE_DL_LIBS})
  target_compile_features(posewise PUBLIC cxx_std_20)
  set_target_properties(posewise PROPERTIES LINKER_LANGUAGE CXX
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
endfunction()
