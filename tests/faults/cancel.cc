// Calls that end in a chosen stage, one after another. Prints a line for each: the time at which it was cancelled, in
// seconds since 1970, so the server's log tells how long it went on.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "absl/time/clock.h"
#include "tests/faults/commands.h"
#include "tests/faults/jobs.h"
#include "tests/faults/raw_stream.h"

namespace latvox::faults {
namespace {

struct CancelOptions {
  std::string server, jobs, job, stage;
  bool deadline = false;
  int times = 5;
  double after_ms = 20;
};

// Makes the call up to the point where its stage begins. In stage "stream" the client reads no further answers.
class StagedCall {
 public:
  // With a deadline, the deadline ends the call.
  StagedCall(grpc::Channel& channel, const Job& job, std::optional<absl::Time> deadline)
      : job_(job), deadline_(deadline) {
    if (deadline) context_.set_deadline(absl::ToChronoTime(*deadline));
    stream_ = OpenStream(channel, Script().method, context_);
  }

  void Reach(const std::string& stage) {
    v1::VoxelizeRequest request;
    *request.mutable_spec() = SpecOf(job_);
    stream_->Write(ToBuffer(request.SerializeAsString()));
    const bool whole = stage != "upload";
    constexpr size_t kPieceBytes = size_t{1} << 20;
    const size_t bytes = whole ? job_.drc.size() : job_.drc.size() / 2;
    for (size_t begin = 0; begin < bytes; begin += kPieceBytes) {
      request.set_mesh_piece(job_.drc.substr(begin, std::min(kPieceBytes, bytes - begin)));
      stream_->Write(ToBuffer(request.SerializeAsString()));
    }
    if (whole) stream_->WritesDone();
    if (stage == "stream") {
      grpc::ByteBuffer accepted;
      stream_->Read(&accepted);
    } else if (stage == "voxelize") {
      reader_ = std::jthread([this] { ReadAll(); });
    }
  }

  // Cancels the call, unless it has a deadline. Returns the time at which it was cancelled or is due to end.
  absl::Time Cancel() {
    if (deadline_) return *deadline_;
    const absl::Time now = absl::Now();
    context_.TryCancel();
    return now;
  }

  grpc::Status End() {
    if (reader_.joinable()) {
      reader_.join();
    } else {
      ReadAll();
    }
    return stream_->Finish();
  }

 private:
  void ReadAll() {
    for (grpc::ByteBuffer answer; stream_->Read(&answer);) {
    }
  }

  const Job& job_;
  const std::optional<absl::Time> deadline_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>> stream_;
  std::jthread reader_;
};

// Gives the server time to become idle, and keeps the connection busy, because gRPC looks at it only during a call.
void Rest(grpc::Channel& channel) {
  Script health;
  health.method = "/grpc.health.v1.Health/Check";
  health.messages.emplace_back();
  for (int n = 0; n < 15; ++n) {
    Run(channel, health);
    absl::SleepFor(absl::Milliseconds(10));
  }
}

int RunCancel(const CancelOptions& options) {
  const auto jobs = ReadJobs(options.jobs, {options.job});
  if (!jobs.ok()) {
    std::fprintf(stderr, "latvox_faults: %s\n", std::string{jobs.status().message()}.c_str());
    return 2;
  }
  const auto channel = OwnChannel(options.server);
  for (int n = 0; n < options.times; ++n) {
    const absl::Duration after = absl::Milliseconds(options.after_ms);
    std::optional<absl::Time> deadline;
    if (options.deadline) deadline = absl::Now() + after;
    StagedCall call(*channel, jobs->front(), deadline);
    call.Reach(options.stage);
    absl::SleepFor(deadline ? *deadline - absl::Now() : after);
    const absl::Time cancelled = call.Cancel();
    const grpc::Status status = call.End();
    std::printf("{\"cancelled\": %.6f, \"code\": %d}\n", absl::ToDoubleSeconds(cancelled - absl::UnixEpoch()),
                status.error_code());
    Rest(*channel);
  }
  return 0;
}

}  // namespace

void AddCancel(CLI::App& program, Command& run) {
  const auto options = std::make_shared<CancelOptions>();
  CLI::App& command = *program.add_subcommand("cancel", "Cancels calls in a stage; prints the times as JSON lines");
  command.add_option("--server", options->server, "Address")->required();
  command.add_option("--jobs", options->jobs, "Table of jobs, JSON")->required();
  command.add_option("--job", options->job, "A job of the table")->required();
  command.add_option("--stage", options->stage)->check(CLI::IsMember({"upload", "decode", "voxelize", "stream"}));
  command.add_option("--after-ms", options->after_ms,
                     "Delay from the beginning of the stage; with a deadline, of the call");
  command.add_flag("--deadline", options->deadline, "A deadline instead of cancelling");
  command.add_option("--times", options->times);
  command.callback([options, &run] { run = [options] { return RunCancel(*options); }; });
}

}  // namespace latvox::faults
