#pragma once

#include <string>

namespace posewise {

/// Where tests find what they read and start. Functions of one file and no macros: objects of tests
/// then hold no path, and another clone need not compile them again.
std::string source_folder();   ///< the repository
std::string real_data();       ///< real measured campaigns of others, perhaps absent
std::string program_path();    ///< the program built
std::string stated_version();  ///< that of CMakeLists.txt

}  // namespace posewise
