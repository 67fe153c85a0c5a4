// A process that gets nothing of this one except some files, and that limits itself.
#ifndef LATVOX_PROCESS_CHILD_H_
#define LATVOX_PROCESS_CHILD_H_

#include <spawn.h>
#include <sys/resource.h>

#include <cstdint>
#include <initializer_list>

namespace latvox {

// The two arguments of posix_spawn for such a process: no other files, no signal settings. It has a group of its own,
// because keys typed at a terminal are for the parent.
class ChildSetting {
 public:
  // The process has the n-th file under number 3 + n. Precondition: no file except the first has such a number, so that
  // no duplicate closes another file.
  explicit ChildSetting(std::initializer_list<int> inherited);
  ~ChildSetting();
  ChildSetting(const ChildSetting&) = delete;
  ChildSetting& operator=(const ChildSetting&) = delete;

  posix_spawnattr_t attributes;
  posix_spawn_file_actions_t files;
};

// Sets this process's limit, and another one at which the system acts at last. A lower limit stays, because only a
// privileged process may raise it. Returns false if that fails; errno has the reason.
bool SetLimit(__rlimit_resource resource, rlim_t limit, rlim_t last);
inline bool SetLimit(__rlimit_resource resource, rlim_t limit) { return SetLimit(resource, limit, limit); }

// Returns the bytes of addresses that this process uses; 0: /proc does not tell.
uint64_t AddressesInUse();

}  // namespace latvox

#endif  // LATVOX_PROCESS_CHILD_H_
