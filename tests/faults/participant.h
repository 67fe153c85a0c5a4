// One client of the swarm: a process with a connection of its own.
#ifndef LATVOX_TESTS_FAULTS_PARTICIPANT_H_
#define LATVOX_TESTS_FAULTS_PARTICIPANT_H_

#include <grpcpp/channel.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/time/clock.h"
#include "latvox/client.h"
#include "tests/faults/chance.h"
#include "tests/faults/jobs.h"
#include "tests/faults/records.h"

namespace latvox::faults {

// The settings that all clients share.
struct Swarm {
  std::string server;  // in the form of Client::Connect
  std::vector<Job> jobs;
  std::vector<std::string> roles;  // of client n: roles[n % size]
  uint64_t seed = 1;
  absl::Time end;             // no call begins after it
  absl::Duration patience;    // for a correct call, tries and waits included
  absl::Duration pause = {};  // of SDK clients at each batch of bricks; some roles have their own
  client::ConnectionOptions connection = {};
  client::RetryPolicy retry = {};
};

// Roles:
//   good     uses the SDK; checks every answer, and the digest of the voxels
//   bare     uses only the protocol, and checks overload answers against it
//   cancel   as good, but cancels or has a deadline, somewhere in the middle
//   vanish   as good, but the process kills itself somewhere in the middle
//   slow     as good, but pauses at each batch, and cancels in the end
//   stopped  reads no batch at all, and cancels in the end
//   hostile  see hostile.h
class Participant {
 public:
  Participant(const Swarm& swarm, int number, int life, const Records& records);

  // Makes calls, one at a time, until swarm.end.
  void Run();

 private:
  void CallBySdk();
  void CallBare();
  bool Connect(Record& record);
  // Sets record.accepted.
  absl::StatusOr<client::Summary> CallOnce(const Job& job, const client::CallOptions& options, Record& record);
  // Sets record.outcome from the answer.
  void Judge(const Job& job, const absl::StatusOr<client::Summary>& summary, bool meant_to_stop, Record& record) const;
  const Job& AnyJob();
  Record NewRecord(const std::string& job) const;
  // Writes the outcome of a try. A refused try that may be repeated after `delay` counts as cut if that is too late.
  void Write(Record& record, absl::Duration delay) const;
  void Wait(absl::Duration delay) const;

  const Swarm& swarm_;
  const int number_, life_;
  const std::string role_;
  const Records& records_;
  const std::shared_ptr<grpc::Channel> channel_;  // connects on first use
  Chance chance_;
  std::optional<client::Client> client_;
  int call_ = 0;   // the current one
  int calls_ = 0;  // over client_
};

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_PARTICIPANT_H_
