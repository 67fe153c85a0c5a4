// A directory for as long as a process lives.
#ifndef LATVOX_CLIENT_INTERNAL_PROCESS_DIRECTORY_H_
#define LATVOX_CLIENT_INTERNAL_PROCESS_DIRECTORY_H_

#include <memory>
#include <string>

namespace latvox::client {

// A directory PARENT/latvox-KERNEL-XXXXXX that only this user can enter. The destructor removes it with its content.
// If the process is killed, the next one of the same user removes it.
class ProcessDirectory {
 public:
  // The length of the path that follows PARENT.
  static constexpr size_t kNameBytes = sizeof("/latvox-01234567-XXXXXX") - 1;

  // Removes the directories that dead processes of this user left in `parent`, then makes one. Returns null, with errno
  // set, if that is impossible.
  static std::unique_ptr<ProcessDirectory> Make(const std::string& parent);
  ~ProcessDirectory();
  ProcessDirectory(const ProcessDirectory&) = delete;
  ProcessDirectory& operator=(const ProcessDirectory&) = delete;

  const std::string& path() const { return path_; }

 private:
  ProcessDirectory(std::string path, int fd);

  const std::string path_;
  const int fd_;  // its lock shows that this process lives
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_PROCESS_DIRECTORY_H_
