#include "server/base/service_manager.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "absl/strings/str_cat.h"
#include "server/base/log.h"

namespace latvox {
namespace {

// Returns 0, or the number of the error.
int SendTo(const std::string& socket_name, absl::string_view message) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket_name.size() >= sizeof(address.sun_path)) return ENAMETOOLONG;
  socket_name.copy(address.sun_path, socket_name.size());
  if (socket_name[0] == '@') address.sun_path[0] = '\0';  // an abstract name
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_name.size());
  const int channel = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (channel < 0) return errno;
  const bool sent = sendto(channel, message.data(), message.size(), MSG_NOSIGNAL,
                           reinterpret_cast<const sockaddr*>(&address), length) >= 0;
  const int error = sent ? 0 : errno;
  close(channel);
  return error;
}

}  // namespace

std::string TakeVariable(const char* name) {
  const char* value = std::getenv(name);
  std::string taken = value == nullptr ? "" : value;
  unsetenv(name);
  return taken;
}

ServiceManager::ServiceManager() : socket_(TakeVariable("NOTIFY_SOCKET")) {
  const std::string interval = TakeVariable("WATCHDOG_USEC"), process = TakeVariable("WATCHDOG_PID");
  is_watched_ = !interval.empty() && (process.empty() || process == absl::StrCat(getpid()));
}

// The time tells the manager which reload this is.
void ServiceManager::Reloading() const {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  Send(absl::StrCat("RELOADING=1\nMONOTONIC_USEC=", absl::ToInt64Microseconds(absl::DurationFromTimespec(now))));
}

void ServiceManager::Stopping(absl::Duration limit) const {
  Send(absl::StrCat("STOPPING=1\nEXTEND_TIMEOUT_USEC=", absl::ToInt64Microseconds(limit)));
}

void ServiceManager::Alive() const {
  if (is_watched_) Send("WATCHDOG=1");
}

void ServiceManager::Send(absl::string_view message) const {
  if (socket_.empty()) return;
  const int error = SendTo(socket_, message);
  if (error == 0) return;
  Log(LogLevel::kWarning, "notify_failed",
      {{"socket", socket_}, {"message", message.substr(0, message.find('\n'))}, {"error", std::strerror(error)}});
}

}  // namespace latvox
