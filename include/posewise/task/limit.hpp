#pragma once

namespace posewise {

/// Whether an error that is known within an interval keeps a limit.
enum class LimitVerdict {
    Kept,     ///< the whole interval is at or below it
    NotKept,  ///< the whole interval is above it
    Open,     ///< the limit is within the interval
};

}  // namespace posewise
