// The server's log on standard error, one line for each event: key=value pairs, or JSON objects.
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

// A text, or a number, which JSON shows without quotes.
struct LogField {
  LogField(absl::string_view field_key, absl::string_view field_value) : key(field_key), value(field_value) {}
  template <std::integral T>
  LogField(absl::string_view field_key, T field_value)
      : key(field_key), value(absl::StrCat(field_value)), is_number(true) {}
  // A finite number with three decimals; fields are milliseconds.
  LogField(absl::string_view field_key, double field_value)
      : key(field_key), value(absl::StrFormat("%.3f", field_value)), is_number(true) {}

  std::string key, value;
  bool is_number = false;
};

// Starts the log and its thread. Lines below `level` are dropped, as are all lines before StartLog and after StopLog.
// No caller of Log waits for standard error; if that is stuck, the oldest lines are lost. gRPC's own messages have
// level debug.
void StartLog(LogLevel level, LogFormat format);

// Takes effect with the next line. Thread-safe between StartLog and StopLog.
void SetLogLevel(LogLevel level);

// Writes the remaining lines.
void StopLog();

// Thread-safe, and cheap enough for gRPC's callbacks. Values are quoted and escaped where necessary. In JSON, bytes
// that are not UTF-8 are replaced.
void Log(LogLevel level, absl::string_view event, const std::vector<LogField>& fields);

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_LOG_H_
