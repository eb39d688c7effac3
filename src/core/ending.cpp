#include "ending_names.hpp"

namespace posewise {

std::string_view ending_name(Ending ending) {
    return detail::name_of(detail::ending_names, ending);
}

}  // namespace posewise
