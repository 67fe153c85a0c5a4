#include "server/decode/decoder_slot.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"
#include "server/base/log.h"
#include "server/decode/decoder_sandbox.h"

namespace latvox {
namespace {

constexpr absl::Duration kStartTimeout = absl::Seconds(30);
constexpr absl::Duration kFirstDelay = absl::Milliseconds(50), kLongestDelay = absl::Seconds(5);

// A process that uses no CPU time, because it was stopped or taken over, is given up after this many times the CPU
// limit, and no sooner than this. On a machine under load, an honest one may take long, too.
constexpr int kWallPerCpu = 10;
constexpr absl::Duration kLeastWall = absl::Seconds(10);

// The limits of a decode follow the bytes, and then the counts that they declare. So a small file cannot cost much,
// whatever Draco believes. A triangle takes Draco up to 0.5 us and 200 bytes, with normals and coordinates of textures.
constexpr absl::Duration kSmallCpuTime = kUnderSanitizer ? absl::Seconds(1) : absl::Milliseconds(100),
                         kCpuTimePerByte = absl::Microseconds(1), kCpuTimePerElement = absl::Microseconds(5);
constexpr uint64_t kMemoryPerElement = uint64_t{1} << 10;

// The number of processes that may end during a job. A process killed by someone else may have been the kernel's choice
// when memory was short. A process that crashed may have been corrupted by the mesh before.
constexpr int kMostKilled = 5, kMostCrashed = 2;

// The bound by bytes holds for each mesh before it declares its counts. Real meshes need some hundred bytes of memory
// for a byte, the densest possible ones 104 KiB.
constexpr uint64_t kSmallMemory = uint64_t{256} << 20, kMemoryPerByte = uint64_t{128} << 10;

constexpr size_t kReceiveBytes = size_t{256} << 10;
constexpr int kReceivesAtOnce = 4;  // then the other slots have their turn
constexpr size_t kSendBytesAtOnce = size_t{1} << 20;

absl::Status TooSlow(absl::Duration limit) {
  const std::string seconds = absl::StrCat(absl::ToDoubleSeconds(limit));
  return MakeError(absl::StatusCode::kResourceExhausted, absl::StrCat("mesh: decoding takes more than ", seconds, " s"),
                   {"DECODER_TIME", "mesh", "", seconds});
}

absl::Status TooBig(uint64_t limit) {
  return MakeError(absl::StatusCode::kResourceExhausted,
                   absl::StrCat("mesh: decoding takes more than ", limit, " bytes of memory"),
                   {"OUT_OF_MEMORY", "mesh", "", absl::StrCat(limit)});
}

absl::Status KilledTooOften() {
  return WithRetry(MakeError(absl::StatusCode::kResourceExhausted,
                             absl::StrCat("mesh: ", kMostKilled, " decoder processes were killed while they had it"),
                             {"DECODER_KILLED", "mesh", absl::StrCat(kMostKilled), ""}),
                   absl::Seconds(1));
}

}  // namespace

DecoderSlot::DecoderSlot(const DecoderOptions& options, DecoderCounters& counters)
    : options_(options),
      counters_(counters),
      start_at_(options.on_demand ? absl::InfiniteFuture() : absl::InfinitePast()),
      buffer_((kReceiveBytes + kMaxFrameBytes + sizeof(FrameHeader)) / sizeof(uint32_t)) {}

void DecoderSlot::Rouse() {
  if (start_at_ == absl::InfiniteFuture()) start_at_ = absl::InfinitePast();
}

void DecoderSlot::StartProcess() {
  absl::StatusOr<std::unique_ptr<DecoderProcess>> process = DecoderProcess::Start(options_);
  if (started_++ > 0) ++counters_.restarts;
  if (!process.ok()) return Fail(std::string(process.status().message()));
  process_ = *std::move(process);
  pid_ = process_->pid();
  ready_ = killed_ = false;
  received_ = 0;
  state_ = State::kStarting;
  give_up_at_ = absl::Now() + kStartTimeout;
}

void DecoderSlot::Fail(std::string why) {
  failure_ = std::move(why);
  state_ = State::kEmpty;
  start_at_ = absl::Now() + std::min(kLongestDelay, kFirstDelay * (1 << std::min(failures_, 10)));
  ++failures_;
  Log(LogLevel::kWarning, "decoder_failed", {{"error", failure_}, {"failures", failures_}});
}

void DecoderSlot::Begin(std::shared_ptr<DecodeJob> job) {
  job_ = std::move(job);
  const EncodedMesh& mesh = job_->mesh;
  const DecodeRequest request{mesh.bytes.size(), job_->limits.max_triangles, job_->limits.max_vertices, mesh.wanted};
  unsent_ = absl::Cord(absl::string_view(reinterpret_cast<const char*>(&request), sizeof(request)));
  unsent_.Append(mesh.bytes);
  receiver_.emplace(job_->limits, job_->reserve, mesh.wanted);
  memory_limit_ = std::min(options_.memory, kSmallMemory + kMemoryPerByte * mesh.bytes.size());
  cpu_at_begin_ = process_->CpuTime();
  declared_ = false;
  state_ = State::kBusy;
  SetLimits(kSmallCpuTime + kCpuTimePerByte * static_cast<double>(mesh.bytes.size()));
  Send();
}

void DecoderSlot::SetLimits(absl::Duration cpu_time) {
  if (options_.memory != kNoMemoryLimit && !kUnderSanitizer) process_->LimitAddressSpace(idle_bytes_ + memory_limit_);
  cpu_limit_ = std::min(options_.cpu_time, cpu_time);
  check_cpu_at_ = absl::Now() + cpu_limit_;
  give_up_at_ = absl::Now() + kWallPerCpu * std::min(options_.cpu_time, std::max(kLeastWall / kWallPerCpu, cpu_limit_));
}

bool DecoderSlot::HandleDeclaration(absl::string_view frame) {
  DeclarationFrame counts{};
  if (std::exchange(declared_, true) || frame.size() != sizeof(counts)) return false;
  std::memcpy(&counts, frame.data(), sizeof(counts));
  const Limits& limits = job_->limits;
  if (counts.triangles > limits.max_triangles || counts.points > limits.max_vertices) return false;
  const uint64_t elements = counts.triangles + counts.points;
  memory_limit_ = std::min(memory_limit_, kSmallMemory + kMemoryPerElement * elements);
  SetLimits(cpu_limit_ + kCpuTimePerElement * static_cast<double>(elements));
  return true;
}

void DecoderSlot::Abort(const absl::Status& status) {
  Finish(status);
  Kill();
}

void DecoderSlot::AppendPolls(std::vector<pollfd>& polls) const {
  if (!process_) return;
  polls.push_back({process_->end(), POLLIN, 0});
  if (state_ == State::kEnding) return;
  polls.push_back({process_->channel(), static_cast<short>(unsent_.empty() ? POLLIN : POLLIN | POLLOUT), 0});
}

absl::Time DecoderSlot::next_timer() const {
  return state_ == State::kEmpty ? start_at_ : std::min(give_up_at_, check_cpu_at_);
}

std::shared_ptr<DecodeJob> DecoderSlot::Serve() {
  if (state_ == State::kEmpty && absl::Now() >= start_at_) StartProcess();
  if (!process_) return nullptr;
  // The end is checked first: all messages sent before it are then complete.
  const std::optional<ProcessEnd> end = process_->ReceiveEnd();
  if (state_ != State::kEnding) {
    Send();
    Receive();
    if (!end) CheckTimes();
  }
  return end ? HandleEnd(*end) : nullptr;
}

void DecoderSlot::Send() {
  for (size_t sent = 0; !unsent_.empty() && sent < kSendBytesAtOnce;) {
    const absl::string_view chunk = *unsent_.chunk_begin();
    const ssize_t taken = send(process_->channel(), chunk.data(), chunk.size(), MSG_NOSIGNAL);
    if (taken < 0) return;  // no room now, or the process is gone, which Receive finds, too
    unsent_.RemovePrefix(static_cast<size_t>(taken));
    sent += static_cast<size_t>(taken);
  }
}

void DecoderSlot::Receive() {
  char* const buffer = reinterpret_cast<char*>(buffer_.data());
  for (int n = 0; n < kReceivesAtOnce && state_ != State::kEnding; ++n) {
    const ssize_t got = recv(process_->channel(), buffer + received_, kReceiveBytes, 0);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (got <= 0) {
      state_ = State::kEnding;
      process_->Kill();  // it may have closed the socket and still live
      return;
    }
    received_ += static_cast<size_t>(got);
    bool good = false;
    try {
      good = HandleFrames();
    } catch (const std::bad_alloc&) {
      return Abort(WithRetry(NoMemoryToDecode(), absl::Seconds(1)));  // of the server itself
    }
    if (good) continue;
    LogTrouble("decoder_broken");
    return Kill();
  }
}

// Handles all whole frames in the buffer, and moves the rest to the front. Returns false for an invalid frame.
bool DecoderSlot::HandleFrames() {
  const char* const buffer = reinterpret_cast<const char*>(buffer_.data());
  size_t at = 0;
  for (FrameHeader header; received_ - at >= sizeof(header); at += sizeof(header) + header.bytes) {
    std::memcpy(&header, buffer + at, sizeof(header));
    if (header.bytes > kMaxFrameBytes || header.bytes % sizeof(uint32_t) != 0) return false;
    if (received_ - at < sizeof(header) + header.bytes) break;
    if (!HandleFrame(header.kind, {buffer + at + sizeof(header), header.bytes})) return false;
    if (state_ == State::kEnding) return true;
  }
  std::memmove(buffer_.data(), buffer + at, received_ - at);
  received_ -= at;
  return true;
}

bool DecoderSlot::HandleFrame(FrameKind kind, absl::string_view frame) {
  if (state_ == State::kStarting) {
    if (kind == FrameKind::kError) {
      failure_ = std::string(DecodeError(frame).message());
      return true;
    }
    ReadyFrame ready{};
    if (kind != FrameKind::kReady || frame.size() != sizeof(ready)) return false;
    std::memcpy(&ready, frame.data(), sizeof(ready));
    idle_bytes_ = ready.address_space_bytes;
    ready_ = true;
    failures_ = 0;
    failure_.clear();
    give_up_at_ = absl::InfiniteFuture();
    state_ = State::kIdle;
    return true;
  }
  if (state_ != State::kBusy) return false;
  if (kind == FrameKind::kDeclaration) return HandleDeclaration(frame);
  switch (receiver_->Receive(kind, frame)) {
    case MeshReceiver::Progress::kMore:
      return true;
    case MeshReceiver::Progress::kBroken:
      return false;
    case MeshReceiver::Progress::kRefused:
      Abort((*std::exchange(receiver_, std::nullopt)).result().status());
      return true;
    case MeshReceiver::Progress::kDone:
      break;
  }
  absl::StatusOr<DecodedMesh> result = std::move(*receiver_).result();
  const bool out_of_memory = IsOutOfMemory(result.status());
  if (out_of_memory) {
    ++counters_.killed_for_memory;
    result = TooBig(memory_limit_);
  }
  const bool all_sent = unsent_.empty();
  Finish(std::move(result));
  if (out_of_memory || !all_sent) Kill();
  return true;
}

void DecoderSlot::CheckTimes() {
  const absl::Time now = absl::Now();
  if (state_ == State::kBusy && now >= check_cpu_at_) {
    const absl::Duration left = cpu_limit_ - (process_->CpuTime() - cpu_at_begin_);
    // A process with a single thread uses no more CPU time than real time.
    check_cpu_at_ = now + std::max(left, absl::Milliseconds(1));
    if (left <= absl::ZeroDuration()) return GiveUp(/*used_up=*/true);
  }
  if (now < give_up_at_) return;
  if (state_ == State::kStarting) {
    failure_ = "it does not get ready";
    return Kill();
  }
  GiveUp(/*used_up=*/false);
}

// A process that does nothing may have been stopped by someone. So the mesh has a second chance.
void DecoderSlot::GiveUp(bool used_up) {
  ++counters_.killed_for_time;
  LogTrouble("decoder_too_slow");
  stuck_ = !used_up && job_->stuck++ == 0;
  if (stuck_) return Kill();
  Abort(TooSlow(cpu_limit_));
}

// Logs an event of the process, with its current job.
void DecoderSlot::LogTrouble(absl::string_view event, const std::string& end) const {
  std::vector<LogField> fields = {{"pid", process_->pid()}};
  if (!end.empty()) fields.emplace_back("end", end);
  fields.emplace_back("bytes", job_ ? job_->mesh.bytes.size() : 0);
  if (job_) fields.emplace_back("request_id", job_->mesh.request_id);
  Log(LogLevel::kWarning, event, fields);
}

std::shared_ptr<DecodeJob> DecoderSlot::HandleEnd(const ProcessEnd& end) {
  if (ready_ && !killed_) LogTrouble("decoder_died", end.ToString());
  pid_ = 0;
  process_.reset();
  state_ = State::kEmpty;
  start_at_ = absl::InfinitePast();
  give_up_at_ = absl::InfiniteFuture();
  if (!ready_) Fail(failure_.empty() ? absl::StrCat("it ended with ", end.ToString()) : failure_);
  // A process that was killed here and still has its job was killed for an invalid frame.
  return job_ ? HandleLostJob(killed_ || end.is_crash()) : nullptr;
}

std::shared_ptr<DecodeJob> DecoderSlot::HandleLostJob(bool crashed) {
  if (stuck_) {
    stuck_ = false;
  } else if (crashed) {
    ++counters_.crashes;
    if (++job_->crashed == kMostCrashed) Finish(BadMesh("the decoder crashed on it"));
  } else if (++job_->killed == kMostKilled) {
    Finish(KilledTooOften());
  }
  if (!job_) return nullptr;
  unsent_.Clear();
  receiver_.reset();
  check_cpu_at_ = absl::InfiniteFuture();
  return std::exchange(job_, nullptr);
}

void DecoderSlot::Finish(absl::StatusOr<DecodedMesh> result) {
  unsent_.Clear();
  receiver_.reset();
  check_cpu_at_ = give_up_at_ = absl::InfiniteFuture();
  if (state_ == State::kBusy) state_ = State::kIdle;
  if (!job_) return;
  ++counters_.decodes;
  std::exchange(job_, nullptr)->done(std::move(result));
}

void DecoderSlot::Kill() {
  if (!process_) return;
  killed_ = true;
  process_->Kill();
  state_ = State::kEnding;
  give_up_at_ = absl::InfiniteFuture();
}

}  // namespace latvox
