#include "tests/faults/participant.h"

#include <csignal>
#include <thread>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "latvox/error.h"
#include "tests/faults/hostile.h"
#include "tests/faults/raw_stream.h"

namespace latvox::faults {
namespace {

constexpr int kCallsPerConnection = 20;
constexpr absl::Duration kReconnectDelay = absl::Milliseconds(200);
constexpr absl::Duration kSlowPause = absl::Milliseconds(100);

double MillisecondsSince(absl::Time start) { return absl::ToDoubleMilliseconds(absl::Now() - start); }

// Bare and hostile clients know only one address.
std::string FirstOf(const std::string& servers) { return servers.substr(0, servers.find(',')); }

// Returns the delay of google.rpc.RetryInfo, if the answer has one in the protocol's form.
std::optional<absl::Duration> RetryDelayOf(const grpc::Status& status) {
  google::rpc::Status details;
  if (!details.ParseFromString(status.error_details())) return std::nullopt;
  for (const auto& any : details.details()) {
    google::rpc::RetryInfo info;
    if (any.Is<google::rpc::RetryInfo>() && any.UnpackTo(&info)) {
      return absl::Seconds(info.retry_delay().seconds()) + absl::Nanoseconds(info.retry_delay().nanos());
    }
  }
  return std::nullopt;
}

// Runs `action` after `delay`, unless it is destroyed before.
class Alarm {
 public:
  Alarm(absl::Duration delay, std::function<void()> action)
      : thread_([end = absl::Now() + delay, action = std::move(action)](const std::stop_token& stop) {
          while (!stop.stop_requested() && absl::Now() < end) absl::SleepFor(absl::Milliseconds(1));
          if (!stop.stop_requested()) action();
        }) {}

 private:
  std::jthread thread_;
};

}  // namespace

Participant::Participant(const Swarm& swarm, int number, int life, const Records& records)
    : swarm_(swarm),
      number_(number),
      life_(life),
      role_(swarm.roles[static_cast<size_t>(number) % swarm.roles.size()]),
      records_(records),
      channel_(OwnChannel(FirstOf(swarm.server))),
      chance_(swarm.seed * 1'000'003 + static_cast<uint64_t>(number) * 1009 + static_cast<uint64_t>(life)) {}

void Participant::Run() {
  Wait(absl::Milliseconds(chance_.Between(0, 300)));
  for (; absl::Now() < swarm_.end; ++call_) {
    if (role_ == "hostile") {
      Record record = NewRecord("");
      const absl::Time start = absl::Now();
      BeHostile(FirstOf(swarm_.server), *channel_, AnyJob(), chance_, record);
      record.ms = MillisecondsSince(start);
      records_.Write(record);
      Wait(absl::Milliseconds(20));
    } else if (role_ == "bare") {
      CallBare();
    } else {
      CallBySdk();
    }
  }
}

// Repeats a refused call as its answer says, until it is done.
void Participant::CallBare() {
  const Job& job = AnyJob();
  Script script;
  v1::VoxelizeRequest request;
  *request.mutable_spec() = SpecOf(job);
  script.messages.push_back(request.SerializeAsString());
  request.set_mesh_piece(job.drc);
  script.messages.push_back(request.SerializeAsString());
  script.timeout = swarm_.patience;
  for (const absl::Time first = absl::Now();;) {
    Record record = NewRecord(job.name);
    const absl::Time start = absl::Now();
    const Ending ending = faults::Run(*channel_, script);
    record.ms = MillisecondsSince(start);
    record.wait_ms = MillisecondsSince(first);
    record.detail = absl::StrCat(ending.status.error_code(), " ", ending.status.error_message());
    record.accepted = ending.answers > 0;  // the first is Accepted
    v1::VoxelizeResponse last;
    const bool whole = ending.status.ok() && last.ParseFromString(ending.last_answer) && last.has_summary();
    const auto asked = RetryDelayOf(ending.status);
    int64_t pushback = -1;
    if (whole) {
      record.outcome = last.summary().certificate().digest() == job.digest ? "done" : "wrong";
    } else if (ending.status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED && !record.accepted && asked &&
               absl::SimpleAtoi(ending.pushback, &pushback) && pushback == absl::ToInt64Milliseconds(*asked)) {
      record.outcome = "refused";
    } else {
      record.outcome = "wrong";
    }
    const absl::Duration delay = asked.value_or(kReconnectDelay) * chance_.Between(1, 1.5);
    Write(record, delay);
    if (record.outcome != "refused") return;
    Wait(delay);
  }
}

bool Participant::Connect(Record& record) {
  if (client_ && ++calls_ < kCallsPerConnection) return true;
  client_.reset();
  calls_ = 0;
  auto connected = client::Client::Connect(swarm_.server, {}, swarm_.connection);
  if (connected.ok()) {
    client_ = *std::move(connected);
    return true;
  }
  record.detail = absl::StrCat("connect: ", connected.status().ToString());
  record.outcome = "wrong";
  records_.Write(record);
  Wait(kReconnectDelay);
  return false;
}

absl::StatusOr<client::Summary> Participant::CallOnce(const Job& job, const client::CallOptions& options,
                                                      Record& record) {
  client::VoxelizeHandlers handlers;
  handlers.on_accepted = [&record](const client::Accepted&) {
    record.accepted = true;
    return absl::OkStatus();
  };
  handlers.on_bricks = [this](const client::BrickBatch&) {
    absl::SleepFor(role_ == "slow" ? kSlowPause : role_ == "stopped" ? swarm_.end - absl::Now() : swarm_.pause);
    return absl::OkStatus();
  };
  return client_->Voxelize(RequestOf(job), job.drc, handlers, options);
}

void Participant::CallBySdk() {
  const Job& job = AnyJob();
  client::CallOptions options;
  options.deadline = absl::Now() + swarm_.patience;
  options.retry = swarm_.retry;
  std::optional<Alarm> alarm;
  const absl::Duration middle = absl::Milliseconds(chance_.LogBetween(1, 1000));
  const bool reads_badly = role_ == "slow" || role_ == "stopped";
  if (role_ == "cancel" && chance_.OneIn(3)) {
    options.deadline = absl::Now() + middle;
  } else if (role_ == "cancel") {
    alarm.emplace(middle, [cancellation = options.cancellation] { cancellation.Cancel(); });
  } else if (role_ == "vanish") {
    alarm.emplace(middle, [this, name = job.name] {
      Record last = NewRecord(name);
      last.outcome = "vanished";
      records_.Write(last);
      raise(SIGKILL);
    });
  } else if (reads_badly) {
    alarm.emplace(swarm_.end - absl::Now(), [cancellation = options.cancellation] { cancellation.Cancel(); });
  }
  const absl::Time first = absl::Now();
  do {
    Record record = NewRecord(job.name);
    if (!Connect(record)) return;
    const absl::Time start = absl::Now();
    const auto summary = CallOnce(job, options, record);
    record.ms = MillisecondsSince(start);
    record.wait_ms = MillisecondsSince(first);
    Judge(job, summary, reads_badly || role_ == "cancel", record);
    const absl::Duration delay =
        client::GetErrorDetails(summary.status()).retry_after.value_or(kReconnectDelay) * chance_.Between(1, 1.5);
    Write(record, delay);
    if (record.outcome != "refused") return;
    Wait(delay);
  } while (!options.cancellation.cancelled() && absl::Now() < *options.deadline);
}

void Participant::Judge(const Job& job, const absl::StatusOr<client::Summary>& summary, bool meant_to_stop,
                        Record& record) const {
  if (summary.ok()) {
    record.outcome = summary->certificate.digest == job.digest ? "done" : "wrong";
    record.detail = summary->certificate.digest;
    record.resumed = summary->resumed;
    return;
  }
  const absl::Status& status = summary.status();
  record.detail = status.ToString();
  if (meant_to_stop && (absl::IsCancelled(status) || absl::IsDeadlineExceeded(status))) {
    record.outcome = "stopped";
  } else if (absl::IsResourceExhausted(status) && !record.accepted && client::GetErrorDetails(status).retry_after) {
    record.outcome = "refused";
  } else {
    record.outcome = "wrong";
  }
}

const Job& Participant::AnyJob() {
  double total = 0;
  for (const Job& job : swarm_.jobs) total += job.weight;
  double at = chance_.Between(0, total);
  for (const Job& job : swarm_.jobs) {
    if ((at -= job.weight) <= 0) return job;
  }
  return swarm_.jobs.front();
}

Record Participant::NewRecord(const std::string& job) const {
  Record record;
  record.client = number_;
  record.life = life_;
  record.call = call_;
  record.role = role_;
  record.job = job;
  return record;
}

void Participant::Write(Record& record, absl::Duration delay) const {
  if (record.outcome == "refused" && absl::Now() + delay >= swarm_.end) record.outcome = "cut";
  records_.Write(record);
}

void Participant::Wait(absl::Duration delay) const { absl::SleepFor(std::min(delay, swarm_.end - absl::Now())); }

}  // namespace latvox::faults
