#include "server/base/log.h"

#include <grpcpp/version_info.h>
#include <spdlog/async.h>
#include <spdlog/async_logger.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
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

constexpr size_t kQueuedLines = 8192;

// Valid from StartLog to StopLog; spdlog owns it.
std::atomic<spdlog::logger*> g_logger = nullptr;
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
  spdlog::init_thread_pool(kQueuedLines, 1);
  auto logger =
      std::make_shared<spdlog::async_logger>("latvoxd", std::make_shared<spdlog::sinks::stderr_sink_mt>(),
                                             spdlog::thread_pool(), spdlog::async_overflow_policy::overrun_oldest);
  logger->set_level(ToSpdlog(level));
  logger->set_pattern(format == LogFormat::kJson ? R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%v})"
                                                 : "time=%Y-%m-%dT%H:%M:%S.%eZ level=%l event=%v",
                      spdlog::pattern_time_type::utc);
  logger->flush_on(spdlog::level::debug);
  spdlog::set_default_logger(logger);
  g_format = format;
  // Kept forever, without its queue: a thread may be about to use it when StopLog runs.
  static auto* const kept = new std::vector<std::shared_ptr<spdlog::logger>>;
  kept->push_back(logger);
  logger->set_error_handler([](const std::string&) {});  // for lines after StopLog
  g_logger = logger.get();
  TakeLogOfGrpc();
}

void SetLogLevel(LogLevel level) {
  if (spdlog::logger* logger = g_logger) logger->set_level(ToSpdlog(level));
}

void StopLog() {
  g_logger = nullptr;
  spdlog::shutdown();
}

void Log(LogLevel level, absl::string_view event, const std::vector<LogField>& fields) {
  spdlog::logger* logger = g_logger;
  if (logger == nullptr || !logger->should_log(ToSpdlog(level))) return;
  logger->log(ToSpdlog(level), "{}", g_format == LogFormat::kJson ? JsonLine(event, fields) : TextLine(event, fields));
}

}  // namespace latvox
