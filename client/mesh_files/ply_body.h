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
    if (format_ == PlyFormat::kAscii) return ReadText();
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
    if (!ok_ || rest_.size() < sizeof(T)) return ok_ = false, T{};
    char bytes[sizeof(T)];
    std::memcpy(bytes, rest_.data(), sizeof(T));
    rest_.remove_prefix(sizeof(T));
    if (format_ == PlyFormat::kBigEndian) std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  double ReadText() {
    const size_t begin = std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size());
    const size_t end = std::min(rest_.find_first_of(" \t\r\n", begin), rest_.size());
    absl::string_view word = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    double value = 0;
    ok_ = ok_ && ParseDouble(word, value);
    return value;
  }

  absl::string_view rest_;
  PlyFormat format_;
  bool ok_ = true;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_PLY_BODY_H_
