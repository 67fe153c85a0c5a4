// Files that may change while the server runs.
#ifndef LATVOX_SERVER_BASE_FILE_WATCH_H_
#define LATVOX_SERVER_BASE_FILE_WATCH_H_

#include <sys/types.h>

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/time/time.h"

namespace latvox {

// Looks at files every second, on a thread of its own. Not by inotify: files that Kubernetes mounts change by way of
// links to other directories.
class FileWatch {
 public:
  FileWatch() = default;
  ~FileWatch();  // does not return while a callback runs
  FileWatch(const FileWatch&) = delete;
  FileWatch& operator=(const FileWatch&) = delete;

  // From what the files are now; so, before they are read. `changed` is called once if one of them has become another,
  // or has another size or time. Empty paths are left out. Before Start.
  void Add(const std::vector<std::string>& paths, std::function<void()> changed);

  // Starts to look, if there is anything to look at.
  void Start();

 private:
  // What tells that a file is not as it was.
  struct Look {
    dev_t device = 0;
    ino_t inode = 0;
    off_t size = -1;  // -1: there is none
    int64_t modified_ns = 0, status_changed_ns = 0;
    bool operator==(const Look&) const = default;
  };
  struct Group {
    std::vector<std::string> paths;
    std::vector<Look> looks;
    std::function<void()> changed;
  };

  static std::vector<Look> LookAt(const std::vector<std::string>& paths);
  void Run();

  std::vector<Group> groups_;  // the thread's, once it runs
  std::mutex mu_;
  std::condition_variable stop_;
  bool stopping_ = false;  // guarded by mu_
  std::thread thread_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_FILE_WATCH_H_
