#include "server/base/log.h"

#include <grpcpp/version_info.h>
#include <spdlog/logger.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <deque>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"

// From 1.65 on, gRPC logs by Abseil, and ignores functions of others.
#define LATVOX_GRPC_LOGS_BY_ABSEIL (GRPC_CPP_VERSION_MAJOR > 1 || GRPC_CPP_VERSION_MINOR >= 65)
#if LATVOX_GRPC_LOGS_BY_ABSEIL
#include "absl/log/globals.h"
#include "absl/log/initialize.h"
#include "absl/log/log_entry.h"
#include "absl/log/log_sink.h"
#include "absl/log/log_sink_registry.h"
#else
#include <grpc/support/log.h>
#endif

namespace latvox {
namespace {

// Writes lines to standard error on a thread of its own. That thread gathers lines for a moment before it writes them,
// because each of its awakenings costs a small request a twentieth of its time.
class GatheringSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  GatheringSink() : thread_([this] { Run(); }) {}
  ~GatheringSink() override { Stop(); }

  // Writes the lines so far. Later ones are lost.
  void Stop() {
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_one();
    if (thread_.joinable()) thread_.join();
  }

 private:
  static constexpr size_t kMostLines = 8192;
  static constexpr auto kGather = std::chrono::milliseconds(5);

  void sink_it_(const spdlog::details::log_msg& message) override {
    if (stopped_) return;
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    lines_.emplace_back(line.data(), line.size());
    if (lines_.size() > kMostLines) lines_.pop_front();
    if (lines_.size() == 1) changed_.notify_one();
  }
  void flush_() override {}

  void Run() {
    std::unique_lock lock(mutex_);
    while (!stopped_ || !lines_.empty()) {
      changed_.wait(lock, [this] { return stopped_ || !lines_.empty(); });
      changed_.wait_for(lock, kGather, [this] { return stopped_; });
      std::string text;
      for (const std::string& line : std::exchange(lines_, {})) text += line;
      lock.unlock();
      std::fwrite(text.data(), 1, text.size(), stderr);
      lock.lock();
    }
  }

  // Guarded by mutex_, as is formatter_.
  std::deque<std::string> lines_;
  bool stopped_ = false;

  std::condition_variable changed_;
  std::thread thread_;  // last, because it uses the others
};

// From StartLog to StopLog.
std::atomic<spdlog::logger*> g_logger = nullptr;
std::shared_ptr<GatheringSink> g_sink;
// Set before g_logger.
LogFormat g_format = LogFormat::kText;

spdlog::level::level_enum ToSpdlog(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
    case LogLevel::kOff:
      break;
  }
  return spdlog::level::off;
}

bool NeedsQuotes(absl::string_view value) {
  return value.empty() || std::any_of(value.begin(), value.end(), [](char c) {
           return !absl::ascii_isgraph(static_cast<unsigned char>(c)) || c == '"' || c == '=' || c == '\\';
         });
}

void AppendField(const LogField& field, std::string& line) {
  absl::StrAppend(&line, " ", field.key, "=");
  if (NeedsQuotes(field.value)) {
    absl::StrAppend(&line, "\"", absl::Utf8SafeCEscape(field.value), "\"");
  } else {
    line += field.value;
  }
}

std::string TextLine(absl::string_view event, const std::vector<LogField>& fields) {
  std::string line(event);
  for (const LogField& field : fields) AppendField(field, line);
  return line;
}

std::string Quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// The part of a line after time and level, up to the closing brace.
std::string JsonLine(absl::string_view event, const std::vector<LogField>& fields) {
  std::string line = absl::StrCat("\"event\":", Quoted(std::string{event}));
  for (const LogField& field : fields) {
    absl::StrAppend(&line, ",", Quoted(field.key), ":", field.is_number ? field.value : Quoted(field.value));
  }
  return line;
}

#if LATVOX_GRPC_LOGS_BY_ABSEIL
class GrpcSink final : public absl::LogSink {
 public:
  void Send(const absl::LogEntry& entry) override {
    Log(LogLevel::kDebug, "grpc", {{"message", std::string{entry.text_message()}}});
  }
};

// Abseil takes a sink once, and writes to standard error as well until it is initialized.
void TakeLogOfGrpc() {
  static const bool taken = [] {
    absl::InitializeLog();
    absl::SetStderrThreshold(absl::LogSeverityAtLeast::kInfinity);
    absl::AddLogSink(new GrpcSink);
    return true;
  }();
  static_cast<void>(taken);
}
#else
void LogFromGrpc(gpr_log_func_args* args) { Log(LogLevel::kDebug, "grpc", {{"message", args->message}}); }
void TakeLogOfGrpc() { gpr_set_log_function(&LogFromGrpc); }
#endif

}  // namespace

void StartLog(LogLevel level, LogFormat format) {
  g_sink = std::make_shared<GatheringSink>();
  // Kept forever: a thread may be about to use it when StopLog runs.
  static auto* const kept = new std::vector<std::unique_ptr<spdlog::logger>>;
  spdlog::logger& logger = *kept->emplace_back(std::make_unique<spdlog::logger>("latvoxd", g_sink));
  logger.set_level(ToSpdlog(level));
  logger.set_pattern(format == LogFormat::kJson ? R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%v})"
                                                : "time=%Y-%m-%dT%H:%M:%S.%eZ level=%l event=%v",
                     spdlog::pattern_time_type::utc);
  g_format = format;
  g_logger = &logger;
  TakeLogOfGrpc();
}

void SetLogLevel(LogLevel level) {
  if (spdlog::logger* logger = g_logger) logger->set_level(ToSpdlog(level));
}

void StopLog() {
  g_logger = nullptr;
  if (g_sink) g_sink->Stop();
}

void Log(LogLevel level, absl::string_view event, const std::vector<LogField>& fields) {
  spdlog::logger* logger = g_logger;
  if (logger == nullptr || !logger->should_log(ToSpdlog(level))) return;
  const std::string line = g_format == LogFormat::kJson ? JsonLine(event, fields) : TextLine(event, fields);
  logger->log(ToSpdlog(level), spdlog::string_view_t(line.data(), line.size()));
}

}  // namespace latvox
