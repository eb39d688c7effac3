#include "places.hpp"

namespace posewise {

std::string source_folder() { return POSEWISE_SOURCE_DIR; }
std::string real_data() { return POSEWISE_REAL_DATA; }
std::string program_path() { return POSEWISE_PROGRAM; }
std::string stated_version() { return POSEWISE_VERSION; }

}  // namespace posewise
