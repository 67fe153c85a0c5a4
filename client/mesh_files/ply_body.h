// The data of a Stanford PLY file.
#ifndef LATVOX_CLIENT_MESH_FILES_PLY_BODY_H_
#define LATVOX_CLIENT_MESH_FILES_PLY_BODY_H_

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "client/mesh_files/number_text.h"
#include "client/mesh_files/ply_header.h"
#include "client/mesh_files/text_lines.h"

namespace latvox::client {

// Reads the numbers after the header in order, element by element. In text, each element is a line.
class PlyBody {
 public:
  // `lines` is the number of lines before `rest`.
  PlyBody(absl::string_view rest, PlyFormat format, size_t lines)
      : rest_(rest), format_(format), lines_(is_text() ? rest : ""), lines_before_(lines) {}

  // Whether all numbers of the element so far could be read. In text, each element begins anew.
  bool ok() const { return ok_; }

  // Whether the file has ended before the element.
  bool ended() const { return ended_; }

  void BeginElement() {
    if (!is_text()) return;
    line_ = "";
    while (line_.empty() && !ended_) {
      ended_ = !lines_.Next(line_);
      line_ = ended_ ? "" : absl::StripAsciiWhitespace(line_);
    }
    ok_ = !ended_;
  }

  // Counts the element if values are left on its line.
  void EndElement() {
    if (line_.empty() || !ok_ || TakeWord(line_).empty()) return;
    if (longer_++ == 0) first_longer_ = line();
  }

  // Returns the lines that have more values than the header tells, and the first of them.
  uint64_t longer() const { return longer_; }
  size_t first_longer() const { return first_longer_; }

  // Returns whether more than white space follows the last element.
  bool HasMore() {
    BeginElement();
    return is_text() ? !ended_ : !absl::StripAsciiWhitespace(rest_).empty();
  }

  // Returns the bytes that are left if numbers lie in them as in memory, otherwise none.
  absl::string_view little_endian() const {
    return format_ == PlyFormat::kLittleEndian && std::endian::native == std::endian::little ? rest_ : "";
  }

  // Leaves out bytes of binary data.
  void Skip(size_t bytes) { rest_.remove_prefix(bytes); }

  bool is_text() const { return format_ == PlyFormat::kAscii; }

  // Returns the line of the element in the file, counted from 1.
  size_t line() const { return lines_before_ + lines_.number(); }

  double ReadNumber(PlyScalar type) {
    if (is_text()) return ReadText();
    switch (type) {
      case PlyScalar::kInt8:
        return ReadBinary<int8_t>();
      case PlyScalar::kUint8:
        return ReadBinary<uint8_t>();
      case PlyScalar::kInt16:
        return ReadBinary<int16_t>();
      case PlyScalar::kUint16:
        return ReadBinary<uint16_t>();
      case PlyScalar::kInt32:
        return ReadBinary<int32_t>();
      case PlyScalar::kUint32:
        return ReadBinary<uint32_t>();
      case PlyScalar::kFloat32:
        return ReadBinary<float>();
      case PlyScalar::kFloat64:
        return ReadBinary<double>();
    }
    return 0;
  }

 private:
  template <class T>
  T ReadBinary() {
    if (!ok_ || rest_.size() < sizeof(T)) {
      ended_ = true;
      return ok_ = false, T{};
    }
    char bytes[sizeof(T)];
    std::memcpy(bytes, rest_.data(), sizeof(T));
    rest_.remove_prefix(sizeof(T));
    if (format_ == PlyFormat::kBigEndian) std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  double ReadText() {
    double value = 0;
    ok_ = ok_ && ParseDouble(TakeWord(line_), value);
    return value;
  }

  absl::string_view rest_;  // of binary data
  PlyFormat format_;
  TextLines lines_;
  size_t lines_before_;
  absl::string_view line_;  // the rest of it
  bool ok_ = true, ended_ = false;
  uint64_t longer_ = 0;
  size_t first_longer_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_PLY_BODY_H_
