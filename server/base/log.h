// The server's log on standard error, one line an event: key=value pairs, or JSON objects.
//
//   time=2025-01-01T12:00:00.000Z level=info event=listening address=127.0.0.1:50151
//   {"time":"2025-01-01T12:00:00.000Z","level":"info","event":"listening","address":"127.0.0.1:50151"}
#ifndef LATVOX_SERVER_BASE_LOG_H_
#define LATVOX_SERVER_BASE_LOG_H_

#include <concepts>
#include <string>
#include <type_traits>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"

namespace latvox {

enum class LogLevel { kDebug, kInfo, kWarning, kError, kOff };
enum class LogFormat { kText, kJson };

// Text, or a number, which JSON has without quotes.
struct LogField {
  LogField(absl::string_view field_key, absl::string_view field_value) : key(field_key), value(field_value) {}
  template <std::integral T>
  LogField(absl::string_view field_key, T field_value)
      : key(field_key), value(absl::StrCat(field_value)), is_number(true) {}
  // Finite. Three decimals: fields are milliseconds.
  LogField(absl::string_view field_key, double field_value)
      : key(field_key), value(absl::StrFormat("%.3f", field_value)), is_number(true) {}

  std::string key, value;
  bool is_number = false;
};

// Lines below `level` are dropped. Before StartLog and after StopLog, all are. Starts a thread: no caller of Log ever
// waits for standard error; if that is stuck, the oldest lines are lost. gRPC's own messages come at level debug.
void StartLog(LogLevel level, LogFormat format);

// From the next line on. Thread-safe between StartLog and StopLog.
void SetLogLevel(LogLevel level);

// Writes what is left.
void StopLog();

// Thread-safe, and cheap enough for gRPC's callbacks. Values are quoted and escaped where they need it; bytes that are
// not UTF-8 are replaced in JSON.
void Log(LogLevel level, absl::string_view event, const std::vector<LogField>& fields);

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_LOG_H_
