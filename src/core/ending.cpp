#include "names.hpp"
#include "posewise/core/progress.hpp"

namespace posewise {

std::string_view ending_name(Ending ending) {
    static constexpr detail::Names<Ending, 10> names{
        {{Ending::NotRun, "not run"},
         {Ending::Converged, "converged"},
         {Ending::Optimal, "optimal"},
         {Ending::RoundoffLimited, "converged to rounding"},
         {Ending::IterationLimit, "iteration limit"},
         {Ending::Stalled, "stalled"},
         {Ending::TimeLimit, "time limit"},
         {Ending::Interrupted, "interrupted"},
         {Ending::NotIdentifiable, "not identifiable"},
         {Ending::Failed, "optimiser failed"}}};
    return detail::name_of(names, ending);
}

}  // namespace posewise
