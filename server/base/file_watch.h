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

// Looks at files every second, on a thread of its own. It does not use inotify, because Kubernetes changes mounted
// files by links to other directories.
class FileWatch {
 public:
  FileWatch() = default;
  ~FileWatch();  // does not return while a callback runs
  FileWatch(const FileWatch&) = delete;
  FileWatch& operator=(const FileWatch&) = delete;

  // Watches these files from now on, so call it before you read them, and before Start. Calls `changed` once if one of
  // them becomes another file, or changes its size or time. Ignores empty paths.
  void Add(const std::vector<std::string>& paths, std::function<void()> changed);

  // Starts to look, if there is any file.
  void Start();

 private:
  // The facts that change when a file changes.
  struct Look {
    dev_t device = 0;
    ino_t inode = 0;
    off_t size = -1;  // -1: there is no file
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

  std::vector<Group> groups_;  // owned by the thread, once it runs
  std::mutex mu_;
  std::condition_variable stop_;
  bool stopping_ = false;  // guarded by mu_
  std::thread thread_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_FILE_WATCH_H_
