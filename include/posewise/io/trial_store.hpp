#pragma once

#include <string>
#include <vector>

#include "posewise/task/trials.hpp"

namespace posewise::io {

/// Opens a file of SQLite in which finished trials are kept, or makes it; a new one that nothing
/// was put into is gone again. It is the store of one version of posewise, and of one process at a
/// time: others may read it meanwhile. What is kept survives a process that is killed, but not
/// always (the last trials, never the file) a machine that loses its power. A trial that is kept
/// already is kept again if the numbers are the same. Throws InputError, and so do the functions,
/// for a file that is none of this, damaged, of another version, being written, or that cannot be
/// written.
TrialStore open_trial_store(const std::string& path);

/// The same to read only: of any version of posewise, while another process writes it, too. Its
/// `keep` throws.
TrialStore read_trial_store(const std::string& path);

/// What a store holds trials of; in an order that does not depend on how they came there.
std::vector<TrialSeries> series_in_store(const std::string& path);

/// Puts all trials of some stores into one more, which may be new or hold trials already: all or,
/// if it throws, none. Throws InputError as open_trial_store(), and if a trial has other numbers in
/// one of them than in another.
void merge_trial_stores(const std::vector<std::string>& from, const std::string& into);

/// Whether there is a file and it is a store of trials, of any format, by its first bytes. Not for
/// one that this process has open: closing a file ends all locks that SQLite has on it.
bool is_trial_store(const std::string& path);

}  // namespace posewise::io
