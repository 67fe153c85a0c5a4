// Members of .npz archives.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_NPZ_MEMBER_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_NPZ_MEMBER_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/tool/output/zip_writer.h"

namespace latvox::client {

// Returns the bytes of a value.
template <class T>
std::string RawBytes(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

// Returns a member whose bytes are at hand.
inline ZipMember SmallMember(const std::string& name, std::string bytes) {
  const uint64_t size = bytes.size();
  const auto rest = std::make_shared<std::string>(std::move(bytes));
  return {name + ".npy", size, [rest](std::string& chunk) { chunk = std::exchange(*rest, {}); }};
}

// Returns a member that copies an array piece by piece. `array` must live until it is written.
template <class T>
ZipMember RowsMember(const std::string& name, std::string header, const std::vector<T>& array) {
  static constexpr size_t kPiece = size_t{1} << 20;
  const uint64_t size = header.size() + array.size() * sizeof(T);
  const auto rest = std::make_shared<std::string>(std::move(header));
  return {name + ".npy", size, [rest, &array, done = size_t{0}](std::string& chunk) mutable {
            if (!rest->empty()) {
              chunk = std::exchange(*rest, {});
              return;
            }
            const size_t now = std::min(kPiece, array.size() * sizeof(T) - done);
            chunk.assign(reinterpret_cast<const char*>(array.data()) + done, now);
            done += now;
          }};
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_NPZ_MEMBER_H_
