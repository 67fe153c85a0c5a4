#include "server/decode/decoder_pool.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"
#include "server/base/process_facts.h"
#include "server/decode/draco_header.h"

namespace latvox {
namespace {

// Meshes of this size take some 50 ms to decode.
constexpr size_t kLargeBytes = size_t{1} << 20;
constexpr uint64_t kLargeTriangles = uint64_t{1} << 18;

// After so many failures in a row, several seconds have passed, and it is useless to wait for a process.
constexpr int kHopelessFailures = 6;

absl::Status Cancelled() { return absl::CancelledError("the decode was cancelled"); }

absl::Status CannotStart(const std::string& why) {
  return absl::UnavailableError(absl::StrCat("no decoder process can be started: ", why));
}

// A file of a kilobyte may have millions of triangles. A file that does not declare its triangles counts as large.
bool IsLarge(const absl::Cord& mesh) {
  const std::string head(mesh.Subcord(0, kDracoHeadBytes));
  return mesh.size() > kLargeBytes || DeclaredTriangles(head).value_or(kLargeTriangles) >= kLargeTriangles;
}

int ToPollTimeout(absl::Time until) {
  if (until == absl::InfiniteFuture()) return -1;
  const absl::Duration left = absl::Ceil(until - absl::Now(), absl::Milliseconds(1));
  return static_cast<int>(std::clamp<int64_t>(absl::ToInt64Milliseconds(left), 0, 60'000));
}

}  // namespace

class DecoderPool::PooledDecode final : public Decoding {
 public:
  PooledDecode(DecoderPool& pool, std::shared_ptr<DecodeJob> job) : pool_(pool), job_(std::move(job)) {}
  void Cancel() override {
    if (const auto job = job_.lock()) pool_.Cancel(job);
  }

 private:
  DecoderPool& pool_;
  const std::weak_ptr<DecodeJob> job_;  // valid until its end
};

DecoderPool::DecoderPool(const DecoderOptions& options) : options_(options), wake_(eventfd(0, EFD_CLOEXEC)) {
  for (int n = 0; n < options_.processes; ++n) slots_.push_back(std::make_unique<DecoderSlot>(options_, counters_));
}

absl::StatusOr<std::unique_ptr<DecoderPool>> DecoderPool::Create(const DecoderOptions& options) {
  if (options.program.empty()) return absl::InvalidArgumentError("there is no program for decoder processes");
  if (options.processes < 1) return absl::InvalidArgumentError("there is no decoder process");
  if (options.memory < 1) return absl::InvalidArgumentError("there is no memory for decoder processes");
  std::unique_ptr<DecoderPool> pool(new DecoderPool(options));
  std::future<absl::Status> first = pool->first_.get_future();
  pool->thread_ = std::thread([&pool = *pool] { pool.Run(); });
  if (options.on_demand) return pool;
  if (absl::Status status = first.get(); !status.ok()) return status;
  return pool;
}

DecoderPool::~DecoderPool() {
  {
    const std::lock_guard lock(mu_);
    stopping_ = true;
  }
  Wake();
  if (thread_.joinable()) thread_.join();
  close(wake_);
}

std::shared_ptr<MeshDecoder::Decoding> DecoderPool::Start(EncodedMesh mesh, const Limits& limits, Reserve reserve,
                                                          Done done) {
  const bool is_large = IsLarge(mesh.bytes);
  auto job =
      std::make_shared<DecodeJob>(DecodeJob{std::move(mesh), limits, std::move(reserve), std::move(done), is_large});
  auto decode = std::make_shared<PooledDecode>(*this, job);
  {
    const std::lock_guard lock(mu_);
    added_.push_back(std::move(job));
  }
  Wake();
  return decode;
}

void DecoderPool::Cancel(std::shared_ptr<DecodeJob> job) {
  {
    const std::lock_guard lock(mu_);
    cancelled_.push_back(std::move(job));
  }
  Wake();
}

DecoderFacts DecoderPool::facts() const {
  double memory = 0;
  for (const auto& slot : slots_) {
    if (const pid_t pid = slot->pid(); pid != 0) memory += PrivateMemoryBytes(pid);
  }
  return {options_.processes,
          counters_.decodes,
          counters_.restarts,
          counters_.crashes,
          counters_.killed_for_time,
          counters_.killed_for_memory,
          memory,
          static_cast<double>(options_.processes) * static_cast<double>(options_.memory)};
}

void DecoderPool::Wake() {
  const uint64_t one = 1;
  static_cast<void>(!write(wake_, &one, sizeof(one)));
}

void DecoderPool::Run() {
  while (HandleInbox()) {
    for (const auto& slot : slots_) {
      if (!queue_.empty()) slot->Rouse();
      if (auto lost = slot->Serve()) queue_.push_front(std::move(lost));
    }
    ReportFirst();
    Assign();
    Wait();
  }
  EndQueued(Cancelled());
  for (const auto& slot : slots_) slot->Abort(Cancelled());
  slots_.clear();
}

// Waits until there is something to do.
void DecoderPool::Wait() {
  std::vector<pollfd> polls = {{wake_, POLLIN, 0}};
  absl::Time until = absl::InfiniteFuture();
  for (const auto& slot : slots_) {
    slot->AppendPolls(polls);
    until = std::min(until, slot->next_timer());
  }
  poll(polls.data(), polls.size(), ToPollTimeout(until));
  if ((polls[0].revents & POLLIN) == 0) return;
  uint64_t count = 0;
  static_cast<void>(!read(wake_, &count, sizeof(count)));
}

// Returns false once the pool is to end.
bool DecoderPool::HandleInbox() {
  std::vector<std::shared_ptr<DecodeJob>> added, cancelled;
  {
    const std::lock_guard lock(mu_);
    added.swap(added_);
    cancelled.swap(cancelled_);
  }
  for (auto& job : added) queue_.push_back(std::move(job));
  for (const auto& job : cancelled) CancelNow(job);
  const std::lock_guard lock(mu_);
  return !stopping_;
}

void DecoderPool::CancelNow(const std::shared_ptr<DecodeJob>& job) {
  if (const auto queued = std::find(queue_.begin(), queue_.end(), job); queued != queue_.end()) {
    queue_.erase(queued);
    return job->done(Cancelled());
  }
  for (const auto& slot : slots_) {
    if (slot->job() == job) return slot->Abort(Cancelled());
  }
}

void DecoderPool::ReportFirst() {
  if (first_is_known_) return;
  for (const auto& slot : slots_) {
    if (!slot->idle() && slot->failures() == 0) continue;
    first_is_known_ = true;
    return first_.set_value(slot->idle() ? absl::OkStatus() : CannotStart(slot->failure()));
  }
}

bool DecoderPool::MayBegin(const DecodeJob& job) const {
  if (!job.is_large) return true;
  const auto large = std::count_if(slots_.begin(), slots_.end(),
                                   [](const auto& slot) { return slot->job() && slot->job()->is_large; });
  return large < std::max(options_.processes - 1, 1);
}

// Removes from the queue the decode whose turn it is; null if none may begin.
std::shared_ptr<DecodeJob> DecoderPool::ReleaseNext() {
  std::map<std::string, int> at_work;
  for (const auto& slot : slots_) {
    if (slot->job()) ++at_work[slot->job()->mesh.client];
  }
  std::erase_if(last_turns_, [&](const auto& turn) {
    const auto is_of_client = [&](const auto& job) { return job->mesh.client == turn.first; };
    return !at_work.contains(turn.first) && std::none_of(queue_.begin(), queue_.end(), is_of_client);
  });
  auto next = queue_.end();
  std::pair<int, uint64_t> least;
  for (auto job = queue_.begin(); job != queue_.end(); ++job) {
    const std::string& client = (*job)->mesh.client;
    const std::pair<int, uint64_t> rank = {at_work[client], last_turns_[client]};
    if (!MayBegin(**job) || (next != queue_.end() && rank >= least)) continue;
    next = job;
    least = rank;
  }
  if (next == queue_.end()) return nullptr;
  std::shared_ptr<DecodeJob> job = std::move(*next);
  queue_.erase(next);
  last_turns_[job->mesh.client] = ++turns_;
  return job;
}

void DecoderPool::Assign() {
  for (const auto& slot : slots_) {
    if (!slot->idle()) continue;
    std::shared_ptr<DecodeJob> next = ReleaseNext();
    if (!next) break;
    slot->Begin(std::move(next));
  }
  const bool hopeless =
      std::all_of(slots_.begin(), slots_.end(), [](const auto& slot) { return slot->failures() >= kHopelessFailures; });
  if (hopeless) EndQueued(WithRetry(CannotStart(slots_[0]->failure()), absl::Seconds(1)));
}

void DecoderPool::EndQueued(const absl::Status& status) {
  for (const auto& job : std::exchange(queue_, {})) job->done(status);
}

}  // namespace latvox
