// Starts the clients as processes, and restarts them when they have killed themselves. This process never uses gRPC,
// which does not survive a fork.
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/faults/commands.h"
#include "tests/faults/participant.h"

namespace latvox::faults {
namespace {

struct SwarmOptions {
  std::string jobs, records, server;
  std::vector<std::string> only;
  std::vector<std::string> roles{"good"};
  int clients = 1;
  double seconds = 10;
  double patience = 120;
  double pause_ms = 0;
  uint64_t seed = 1;
  std::optional<double> keepalive;
  std::optional<int> retries;
};

// How long clients may go on after the last call's patience is over.
constexpr absl::Duration kLastCall = absl::Seconds(10);

class Starter {
 public:
  Starter(const Swarm& swarm, const Records& records) : swarm_(swarm), records_(records) {}

  void Start(int number) {
    const pid_t parent = getpid();
    const int life = lives_++;
    const pid_t pid = fork();
    if (pid < 0) {
      std::perror("fork");
      std::exit(2);
    }
    if (pid > 0) {
      number_of_[pid] = number;
      return;
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) std::_Exit(0);
    Participant(swarm_, number, life, records_).Run();
    std::_Exit(0);  // gRPC's library would shut down during its own calls
  }

  // Waits until all have ended. Restarts those that have killed themselves, as long as there is time.
  void Wait() {
    const absl::Time give_up = swarm_.end + swarm_.patience + kLastCall;
    while (!number_of_.empty()) {
      int status = 0;
      const pid_t pid = waitpid(-1, &status, WNOHANG);
      if (pid > 0) {
        Ended(pid, status);
      } else if (absl::Now() > give_up) {
        KillAll();
      } else {
        absl::SleepFor(absl::Milliseconds(5));
      }
    }
  }

 private:
  void Ended(pid_t pid, int status) {
    const int number = number_of_.extract(pid).mapped();
    const bool vanished = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    if (vanished && absl::Now() < swarm_.end) return Start(number);
    if (!vanished && status != 0) Complain(number, absl::StrCat("the client's process ended with status ", status));
  }

  void KillAll() {
    for (const auto& [pid, number] : number_of_) {
      Complain(number, "the client did not end");
      kill(pid, SIGKILL);
      waitpid(pid, nullptr, 0);
    }
    number_of_.clear();
  }

  void Complain(int number, const std::string& what) {
    Record record;
    record.client = number;
    record.role = swarm_.roles[static_cast<size_t>(number) % swarm_.roles.size()];
    record.outcome = "wrong";
    record.detail = what;
    records_.Write(record);
  }

  const Swarm& swarm_;
  const Records& records_;
  std::map<pid_t, int> number_of_;
  int lives_ = 0;
};

int RunSwarm(const SwarmOptions& options) {
  auto jobs = ReadJobs(options.jobs, options.only);
  if (!jobs.ok()) {
    std::fprintf(stderr, "latvox_faults: %s\n", std::string{jobs.status().message()}.c_str());
    return 2;
  }
  Swarm swarm{.server = options.server,
              .jobs = *std::move(jobs),
              .roles = options.roles,
              .seed = options.seed,
              .end = absl::Now() + absl::Seconds(options.seconds),
              .patience = absl::Seconds(options.patience),
              .pause = absl::Milliseconds(options.pause_ms)};
  if (options.keepalive) {
    swarm.connection.keepalive_time = swarm.connection.keepalive_timeout = absl::Seconds(*options.keepalive);
  }
  if (options.retries) swarm.retry.max_retries = *options.retries;
  const Records records(options.records);
  Starter starter(swarm, records);
  for (int n = 0; n < options.clients; ++n) starter.Start(n);
  starter.Wait();
  return 0;
}

}  // namespace

void AddSwarm(CLI::App& program, Command& run) {
  const auto options = std::make_shared<SwarmOptions>();
  CLI::App& command = *program.add_subcommand("swarm", "Many clients at once");
  command.add_option("--server", options->server, "Address")->required();
  command.add_option("--jobs", options->jobs, "Table of jobs, JSON")->required();
  command.add_option("--records", options->records, "File to which outcomes are appended")->required();
  command.add_option("--job", options->only, "Only these jobs; may be repeated");
  command.add_option("--roles", options->roles, "Roles of the clients, in turns")->delimiter(',');
  command.add_option("--clients", options->clients, "Clients at once");
  command.add_option("--seconds", options->seconds, "Time in which calls begin");
  command.add_option("--patience", options->patience, "Seconds that a good call may take");
  command.add_option("--pause-ms", options->pause_ms, "Milliseconds that clients of the SDK pause at each batch");
  command.add_option("--keepalive", options->keepalive,
                     "Seconds until a silent server gets a ping, and for its answer");
  command.add_option("--retries", options->retries, "Rounds of retries of a call");
  command.add_option("--seed", options->seed, "Seed of all random choices");
  command.callback([options, &run] { run = [options] { return RunSwarm(*options); }; });
}

}  // namespace latvox::faults
