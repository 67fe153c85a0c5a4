// The statements of a Wavefront OBJ file.
#ifndef LATVOX_CLIENT_MESH_FILES_OBJ_STATEMENTS_H_
#define LATVOX_CLIENT_MESH_FILES_OBJ_STATEMENTS_H_

#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "client/mesh_files/text_lines.h"

namespace latvox::client {

// Reads the statements of a text. A line that ends in a backslash continues on the next one.
class ObjStatements {
 public:
  explicit ObjStatements(absl::string_view text) : lines_(text) {}

  // Returns false at the end.
  bool Next(absl::string_view& statement) {
    if (!lines_.Next(statement)) return false;
    line_ = lines_.number();
    if (!IsContinued(statement)) return true;
    joined_.clear();
    while (IsContinued(statement)) {
      statement.remove_suffix(1);
      absl::StrAppend(&joined_, statement, " ");
      if (!lines_.Next(statement)) statement = "";
    }
    absl::StrAppend(&joined_, statement);
    statement = joined_;
    return true;
  }

  // Returns the first line of the statement, counted from 1.
  size_t line() const { return line_; }

 private:
  static bool IsContinued(absl::string_view line) { return !line.empty() && line.back() == '\\'; }

  TextLines lines_;
  std::string joined_;
  size_t line_ = 0;
};

inline std::string NameOfLine(size_t line) { return absl::StrCat("line ", line); }

template <class... Parts>
absl::Status LineError(size_t line, const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat("line ", line, ": ", parts...));
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_OBJ_STATEMENTS_H_
