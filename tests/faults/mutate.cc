// Nearly right requests over many parallel streams, and now and then a correct one, which must be answered.
#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/mesh_files/input.h"
#include "tests/faults/commands.h"
#include "tests/faults/good_scripts.h"
#include "tests/faults/hostile.h"
#include "tests/faults/mutations.h"
#include "tests/faults/raw_http2.h"

namespace latvox::faults {
namespace {

struct MutateOptions {
  std::string server, mesh;
  uint64_t requests = 1000;
  int streams = 32;
  uint64_t seed = 1;
};

constexpr int kStreamsPerChannel = 8;
constexpr uint64_t kGoodEvery = 100;
// A connection of raw bytes costs more than a stream, and finds fewer of our defects.
constexpr uint64_t kConnectionEvery = 4;

// Counts of all outcomes: how often each status came, and violations.
class Tally {
 public:
  void Count(const std::string& what) {
    const std::lock_guard lock(mu_);
    ++counts_[what];
  }
  void Complain(const std::string& what) {
    const std::lock_guard lock(mu_);
    if (complaints_.size() < 20) complaints_.push_back(what);
  }
  std::string ToJson() const { return nlohmann::json{{"counts", counts_}, {"complaints", complaints_}}.dump(); }

 private:
  std::mutex mu_;
  std::map<std::string, uint64_t> counts_;
  std::vector<std::string> complaints_;
};

std::string Name(const Script& script) { return script.method.substr(script.method.rfind('/') + 1); }

void SendBytes(const std::string& server, const Script& script, Chance& chance, Tally& tally) {
  RawConnection connection(server);
  if (!connection.connected()) return tally.Complain("the server does not take connections");
  connection.Send(MutatedConnection(script, chance));
  tally.Count(connection.WaitUntilClosed(absl::Milliseconds(20)) ? "bytes: connection closed" : "bytes: left open");
  if (chance.OneIn(2)) connection.Reset();
}

// Returns request number n, the same on every thread.
void SendRequest(const MutateOptions& options, const std::string& drc, uint64_t n, grpc::Channel& channel,
                 Tally& tally) {
  Chance chance(options.seed * 1'000'003 + n);
  if (n % kGoodEvery == 0) {
    const Script script = GoodScript(drc, chance);
    const Ending ending = Run(channel, script);
    tally.Count(absl::StrCat("good ", Name(script), ": ", ending.status.error_code()));
    // GoodScript may ask for a mesh, a tile or a combination that does not exist.
    if (!IsFairAnswer(ending.status)) {
      tally.Complain(
          absl::StrCat("request ", n, ", good: ", ending.status.error_code(), " ", ending.status.error_message()));
    }
    return;
  }
  const Script script = MutatedScript(drc, chance);
  if (n % kConnectionEvery == 0) return SendBytes(options.server, script, chance, tally);
  const Ending ending = Run(channel, script);
  tally.Count(absl::StrCat(Name(script), ": ", ending.status.error_code()));
  if (!IsFairAnswer(ending.status)) {
    tally.Complain(absl::StrCat("request ", n, ", ", Name(script), ": ", ending.status.error_code(), " ",
                                ending.status.error_message()));
  }
}

int Mutate(const MutateOptions& options) {
  const auto drc = client::ReadBytes(options.mesh);
  if (!drc.ok()) {
    std::fprintf(stderr, "latvox_faults: %s\n", std::string{drc.status().message()}.c_str());
    return 2;
  }
  Tally tally;
  std::atomic<uint64_t> next = 0;
  std::vector<std::shared_ptr<grpc::Channel>> channels;
  for (int n = 0; n < options.streams; n += kStreamsPerChannel) channels.push_back(OwnChannel(options.server));
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < options.streams; ++t) {
      threads.emplace_back([&, channel = channels[static_cast<size_t>(t) % channels.size()]] {
        for (uint64_t n; (n = next++) < options.requests;) SendRequest(options, *drc, n, *channel, tally);
      });
    }
  }
  std::puts(tally.ToJson().c_str());
  return 0;
}

}  // namespace

void AddMutate(CLI::App& program, Command& run) {
  const auto options = std::make_shared<MutateOptions>();
  CLI::App& command = *program.add_subcommand("mutate", "Sends nearly right requests; prints their outcomes as JSON");
  command.add_option("--server", options->server, "Address")->required();
  command.add_option("--mesh", options->mesh, "A small .drc file")->required();
  command.add_option("--requests", options->requests, "Number of requests");
  command.add_option("--streams", options->streams, "Streams at once");
  command.add_option("--seed", options->seed, "Seed of all random choices");
  command.callback([options, &run] { run = [options] { return Mutate(*options); }; });
}

}  // namespace latvox::faults
