#include "client/internal/private_server.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

extern char** environ;

namespace latvox::client {
namespace {

constexpr absl::Duration kStartLimit = absl::Seconds(20), kEndLimit = absl::Seconds(3);
constexpr absl::Duration kPoll = absl::Milliseconds(1);
constexpr char kSocketName[] = "/socket";

std::string FindProgram(const std::string& given) {
  if (!given.empty()) return given;
  if (const char* named = std::getenv("LATVOX_LATVOXD"); named != nullptr && *named != '\0') return named;
  std::error_code error;
  const auto beside = std::filesystem::read_symlink("/proc/self/exe", error).replace_filename("latvoxd");
  if (!error && access(beside.c_str(), X_OK) == 0) return beside.string();
  return "latvoxd";
}

// Resets signals for a fresh program and gives it its own process group. So an interrupt at the terminal reaches only
// this program, which ends the server in order.
void SetUp(posix_spawnattr_t& attributes, posix_spawn_file_actions_t& files) {
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  // Standard output belongs to this program, and another one may read it.
  posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&files,
                                           STDERR_FILENO + 1);  // whoever waits for their end waits for us alone
}

// Returns the environment without the variables of other servers: configuration file, addresses, TLS and tokens.
std::vector<char*> EnvironmentOfPrivateServer() {
  constexpr absl::string_view kPublic[] = {
      "LATVOX_CONFIG=",   "LATVOX_HEALTH_LISTEN=", "LATVOX_METRICS_LISTEN=", "LATVOX_INSECURE=",
      "LATVOX_TLS_CERT=", "LATVOX_TLS_KEY=",       "LATVOX_TLS_CLIENT_CA=",  "LATVOX_TOKEN_FILE="};
  std::vector<char*> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const auto names = [&](absl::string_view name) { return absl::StartsWith(*variable, name); };
    if (std::none_of(std::begin(kPublic), std::end(kPublic), names)) variables.push_back(*variable);
  }
  variables.push_back(nullptr);
  return variables;
}

bool Accepts(const std::string& path) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  const bool accepted = connect(fd, reinterpret_cast<const sockaddr*>(&name), sizeof(name)) == 0;
  close(fd);
  return accepted;
}

// Waits until the child has ended or the time is over. Returns whether the child has ended.
bool AwaitEnd(pid_t pid, absl::Duration limit) {
  const absl::Time give_up = absl::Now() + limit;
  for (;;) {
    const pid_t ended = waitpid(pid, nullptr, WNOHANG);
    if (ended == pid || (ended < 0 && errno == ECHILD)) return true;
    if (absl::Now() >= give_up) return false;
    absl::SleepFor(kPoll);
  }
}

std::string Describe(int wait_status) {
  return WIFSIGNALED(wait_status) ? absl::StrCat("signal ", WTERMSIG(wait_status))
                                  : absl::StrCat("status ", WEXITSTATUS(wait_status));
}

}  // namespace

absl::StatusOr<std::unique_ptr<PrivateServer>> PrivateServer::Start(
    const PrivateServerOptions& options, const std::function<void(const std::string& path)>& on_directory) {
  std::unique_ptr<PrivateServer> server(new PrivateServer);
  if (auto status = server->MakeDirectory(); !status.ok()) return status;
  if (on_directory) on_directory(server->directory_->path());
  if (auto status = server->Spawn(options); !status.ok()) return status;
  return server;
}

PrivateServer::~PrivateServer() {
  End();
  if (pid_ > 0 && !AwaitEnd(pid_, kEndLimit)) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
}

// A second signal would break off its orderly end.
void PrivateServer::End() {
  if (pid_ > 0 && !ends_) kill(pid_, SIGTERM);
  ends_ = true;
}

void PrivateServer::RemoveDirectory() { directory_.reset(); }

std::string PrivateServer::address() const { return absl::StrCat("unix:", socket_path_); }

absl::Status PrivateServer::MakeDirectory() {
  int error_number = 0;
  for (const char* parent : {static_cast<const char*>(std::getenv("XDG_RUNTIME_DIR")), "/tmp"}) {
    if (parent == nullptr || *parent == '\0') continue;
    // A deep runtime directory may exceed the short limit of a socket's path.
    constexpr size_t kMore = ProcessDirectory::kNameBytes + std::char_traits<char>::length(kSocketName);
    if (std::strlen(parent) + kMore >= sizeof(sockaddr_un::sun_path)) continue;
    directory_ = ProcessDirectory::Make(parent);
    if (directory_) {
      socket_path_ = directory_->path() + kSocketName;
      return absl::OkStatus();
    }
    error_number = errno;
  }
  return absl::UnavailableError(
      absl::StrCat("cannot create a directory for a private latvoxd: ", std::strerror(error_number)));
}

absl::Status PrivateServer::Spawn(const PrivateServerOptions& options) {
  program_ = FindProgram(options.program);
  std::vector<std::string> words = {program_, "--listen", address(), "--parent-pid", absl::StrCat(getpid())};
  words.insert(words.end(), {"--exit-with-parent", "--decoders-on-demand", "--log-level", "warning"});
  if (options.threads) {
    words.push_back("--threads");
    words.push_back(absl::StrCat(*options.threads));
  }
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_t files;
  SetUp(attributes, files);
  const int error_number =
      posix_spawnp(&pid_, program_.c_str(), &files, &attributes, arguments.data(), EnvironmentOfPrivateServer().data());
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (error_number == 0) return absl::OkStatus();
  pid_ = -1;
  return absl::UnavailableError(
      absl::StrCat("cannot start ", program_, ": ", std::strerror(error_number), "; LATVOX_LATVOXD may name it"));
}

absl::Status PrivateServer::AwaitReady(const CallOptions& options) {
  const absl::Time give_up = absl::Now() + kStartLimit;
  while (!Accepts(socket_path_)) {
    int wait_status = 0;
    if (waitpid(pid_, &wait_status, WNOHANG) == pid_) {
      pid_ = -1;
      return absl::UnavailableError(absl::StrCat(program_, " ended with ", Describe(wait_status), " before it served"));
    }
    if (options.cancellation.cancelled()) return absl::CancelledError("cancelled");
    if (options.deadline && absl::Now() >= *options.deadline) {
      return absl::DeadlineExceededError(absl::StrCat("the deadline passed while ", program_, " started"));
    }
    if (absl::Now() >= give_up) {
      return absl::UnavailableError(
          absl::StrCat(program_, " did not serve within ", absl::FormatDuration(kStartLimit)));
    }
    absl::SleepFor(kPoll);
  }
  return absl::OkStatus();
}

}  // namespace latvox::client
