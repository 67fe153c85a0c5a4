// One client of the swarm: a process of its own, with a connection of its own.
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

// What all clients share.
struct Swarm {
  std::string server;  // as Client::Connect takes it
  std::vector<Job> jobs;
  std::vector<std::string> roles;  // of client n: roles[n % size]
  uint64_t seed = 1;
  absl::Time end;             // no call begins after it
  absl::Duration patience;    // that a good call may take, tries and waits included
  absl::Duration pause = {};  // of clients of the SDK at each batch of bricks; some roles have their own
  client::ConnectionOptions connection = {};
  client::RetryPolicy retry = {};
};

// Roles:
//   good     uses the SDK, checks every answer and the digest of what it got
//   bare     uses the protocol alone, and holds overload answers against it
//   cancel   as good, but cancels or has a deadline, somewhere in the middle
//   vanish   as good, but the process kills itself somewhere in the middle
//   slow     as good, but takes a while over each batch, and cancels in the end
//   stopped  takes no batch at all, and cancels in the end
//   hostile  see hostile.h
class Participant {
 public:
  Participant(const Swarm& swarm, int number, int life, const Records& records);

  // Calls, one at a time, until swarm.end.
  void Run();

 private:
  void CallBySdk();
  void CallBare();
  bool Connect(Record& record);
  // Sets record.accepted.
  absl::StatusOr<client::Summary> CallOnce(const Job& job, const client::CallOptions& options, Record& record);
  // Sets record.outcome from what has come.
  void Judge(const Job& job, const absl::StatusOr<client::Summary>& summary, bool meant_to_stop, Record& record) const;
  const Job& AnyJob();
  Record NewRecord(const std::string& job) const;
  // Writes what became of a try. One that is refused, and may be made again after `delay`, is cut if that is too late.
  void Write(Record& record, absl::Duration delay) const;
  void Wait(absl::Duration delay) const;

  const Swarm& swarm_;
  const int number_, life_;
  const std::string role_;
  const Records& records_;
  const std::shared_ptr<grpc::Channel> channel_;  // connects when it is used
  Chance chance_;
  std::optional<client::Client> client_;
  int call_ = 0;   // the one being made
  int calls_ = 0;  // over client_
};

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_PARTICIPANT_H_
