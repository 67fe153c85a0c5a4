// Locks that tell whether the process which made a temporary file or directory still lives.
//
// The names carry a tag of the running kernel, because a lock by flock() may be invisible to other machines. The kernel
// drops the locks of a process that ends, however it ends. So a thing with this kernel's tag and without a lock belongs
// to a dead process, in whichever container that ran.
#ifndef LATVOX_CLIENT_INTERNAL_LIVENESS_H_
#define LATVOX_CLIENT_INTERNAL_LIVENESS_H_

#include <string>

namespace latvox::client {

// Eight characters that all processes of this running kernel share. Empty if the system does not tell them: then
// nothing proves that a process is dead.
const std::string& KernelTag();

enum class Lock {
  kHeld,         // by this descriptor until it closes; `path` leads to its file
  kOthers,       // another process has the lock, or has removed or replaced the file
  kUnsupported,  // the file system has no locks
};

// Locks the file or directory that was opened from `path`. Does not wait.
Lock LockFile(int fd, const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_LIVENESS_H_
