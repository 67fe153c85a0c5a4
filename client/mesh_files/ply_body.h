// The data of a Stanford PLY file.
#ifndef LATVOX_CLIENT_MESH_FILES_PLY_BODY_H_
#define LATVOX_CLIENT_MESH_FILES_PLY_BODY_H_

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include "absl/strings/string_view.h"
#include "client/mesh_files/ply_header.h"

namespace latvox::client {

// Reads the numbers after the header in order. After the end or an unreadable number, `ok` stays false.
class PlyBody {
 public:
  PlyBody(absl::string_view rest, PlyFormat format) : rest_(rest), format_(format) {}

  bool ok() const { return ok_; }

  double ReadNumber(PlyScalar type) {
    if (format_ == PlyFormat::kAscii) return ReadText<double>();
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

  // One rounding: decimal text goes directly to float32, not through double.
  float ReadFloat(PlyScalar type) {
    return format_ == PlyFormat::kAscii ? ReadText<float>() : static_cast<float>(ReadNumber(type));
  }

 private:
  template <class T>
  T ReadBinary() {
    if (!ok_ || rest_.size() < sizeof(T)) return ok_ = false, T{};
    char bytes[sizeof(T)];
    std::memcpy(bytes, rest_.data(), sizeof(T));
    rest_.remove_prefix(sizeof(T));
    if (format_ == PlyFormat::kBigEndian) std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  template <class T>
  T ReadText() {
    const size_t begin = std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size());
    const size_t end = std::min(rest_.find_first_of(" \t\r\n", begin), rest_.size());
    absl::string_view word = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    if (!word.empty() && word[0] == '+') word.remove_prefix(1);
    T value{};
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc::result_out_of_range) value = FromText<T>(std::string(word));
    ok_ = ok_ && !word.empty() && stop == word.data() + word.size() && error != std::errc::invalid_argument;
    return value;
  }

  // Handles overflow and underflow, where from_chars returns no value.
  template <class T>
  static T FromText(const std::string& word) {
    return static_cast<T>(sizeof(T) == sizeof(float) ? std::strtof(word.c_str(), nullptr)
                                                     : std::strtod(word.c_str(), nullptr));
  }

  absl::string_view rest_;
  PlyFormat format_;
  bool ok_ = true;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_PLY_BODY_H_
