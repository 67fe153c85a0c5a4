// Tells systemd, or another service manager with its protocol, how the process is: sd_notify(3).
#ifndef LATVOX_SERVER_BASE_SERVICE_MANAGER_H_
#define LATVOX_SERVER_BASE_SERVICE_MANAGER_H_

#include <string>

#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace latvox {

// Returns the value of a variable of the environment, or nothing, and removes the variable. Call it before any thread.
std::string TakeVariable(const char* name);

// Does nothing without $NOTIFY_SOCKET. Thread-safe. libsystemd would bring four compression libraries along, which the
// decoders would have to load, too.
class ServiceManager {
 public:
  // Takes its variables out of the environment, so that decoder processes do not speak for this one. Construct it
  // before any thread.
  ServiceManager();

  // The process serves, or serves again after Reloading.
  void Ready() const { Send("READY=1"); }
  void Reloading() const;

  // The process ends, within this time.
  void Stopping(absl::Duration limit) const;

  // The process is not stuck. Sends that only if the manager waits for it.
  void Alive() const;

 private:
  void Send(absl::string_view message) const;

  std::string socket_;  // a path, or @ and a name; empty: there is no manager
  bool is_watched_ = false;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_SERVICE_MANAGER_H_
