// The header of an OFF file.
#ifndef LATVOX_CLIENT_MESH_FILES_OFF_HEADER_H_
#define LATVOX_CLIENT_MESH_FILES_OFF_HEADER_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh_files/text_lines.h"

namespace latvox::client {

struct OffHeader {
  bool has_texture = false, has_colors = false, has_normals = false;  // of vertices: ST, C, N before OFF
  bool is_binary = false;
  uint64_t vertices = 0, faces = 0;  // in text; in binary files they follow the header
};

// The lines of a text that have words, without comments, which begin with #.
class OffLines {
 public:
  explicit OffLines(absl::string_view text) : lines_(text) {}

  // Returns false at the end.
  bool Next(std::vector<absl::string_view>& words);

  // Returns the number of the last line, counted from 1.
  size_t number() const { return lines_.number(); }

  // Returns what follows the last line.
  absl::string_view rest() const { return lines_.rest(); }

 private:
  TextLines lines_;
};

// Returns whether the bytes begin like an OFF file: OFF, with letters before it that this reader knows or refuses.
bool IsOff(absl::string_view bytes);

// Reads the lines of the header. The counts of a text may stand on the line of the keyword, even without a space, and
// the keyword may be missing. Errors: INVALID_ARGUMENT naming the line: there is neither keyword nor counts; vertices
// have four coordinates (4OFF) or a dimension (nOFF).
absl::StatusOr<OffHeader> ReadOffHeader(OffLines& lines);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_OFF_HEADER_H_
