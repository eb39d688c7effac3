#pragma once

#include <string>

namespace posewise::detail {

/// Lets one process at a time write a file: by a lock on another file beside it, `file-lock`, which
/// the system takes back from a process that is killed. Throws InputError, which names the path
/// that users know, if it is taken or cannot be had.
class WriterLock {
  public:
    WriterLock(const std::string& file, const std::string& path);
    ~WriterLock();
    WriterLock(const WriterLock&) = delete;
    WriterLock& operator=(const WriterLock&) = delete;

  private:
    std::string name_;
    int fd_ = -1;
};

}  // namespace posewise::detail
