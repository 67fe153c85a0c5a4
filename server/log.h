// The server's log: lines of key=value pairs on standard error.
//
//   time=2025-01-01T12:00:00.000Z level=info event=listening address=127.0.0.1:50151
#ifndef LATVOX_SERVER_LOG_H_
#define LATVOX_SERVER_LOG_H_

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace latvox {

enum class LogLevel { kDebug, kInfo, kWarning, kError, kOff };

struct LogField {
  LogField(absl::string_view field_key, const absl::AlphaNum& field_value)
      : key(field_key), value(field_value.Piece()) {}
  std::string key, value;
};

// Lines below `level` are dropped. Before StartLog and after StopLog, all are. Starts a thread: no caller of Log ever
// waits for standard error; if that is stuck, the oldest lines are lost. gRPC's own messages come at level debug.
void StartLog(LogLevel level);

// Writes what is left.
void StopLog();

// Thread-safe, and cheap enough for gRPC's callbacks. Values are quoted and escaped where they need it.
void Log(LogLevel level, absl::string_view event, const std::vector<LogField>& fields);

}  // namespace latvox

#endif  // LATVOX_SERVER_LOG_H_
