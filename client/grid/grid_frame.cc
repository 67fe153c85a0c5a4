#include "client/grid/grid_frame.h"

#include <openvdb/version.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/internal/printable.h"

namespace latvox::client {
namespace {

constexpr uint64_t kBytesOfUuid = 36;
constexpr uint64_t kLeastGrid = 3 * 4 + 3 * 8;                // three texts and three places
constexpr uint64_t kLeastMetadata = 3 * 4;                    // two texts and a size
constexpr std::pair<std::string_view, uint32_t> kSizes[] = {  // of values, in bytes, by type
    {"bool", 1},   {"float", 4},  {"double", 8}, {"int32", 4},  {"int64", 8},  {"vec2i", 8},
    {"vec2s", 8},  {"vec2d", 16}, {"vec3i", 12}, {"vec3s", 12}, {"vec3d", 24}, {"vec4i", 16},
    {"vec4s", 16}, {"vec4d", 32}, {"mat4s", 64}, {"mat4d", 128}};

class FrameReader {
 public:
  FrameReader(std::istream& in, uint64_t size) : in_(in), size_(size) {}

  GridFrame Read() {
    Seek(0);
    ReadHeader();
    ReadMetadata();
    const auto count = Get<int32_t>();
    if (count < 0 || static_cast<uint64_t>(count) > size_ / kLeastGrid) Fail("it has ", count, " grids");
    GridFrame frame;
    for (int32_t n = 0; n < count; ++n) frame.grids.push_back(ReadGrid());
    return frame;
  }

 private:
  template <class... Words>
  [[noreturn]] static void Fail(const Words&... words) {
    throw std::runtime_error(absl::StrCat(words...));
  }

  void Need(uint64_t bytes) const {
    if (bytes > size_ - at_) Fail("it is cut short: ", size_, " bytes, and ", bytes, " more are needed at ", at_);
  }

  void Seek(uint64_t at) {
    at_ = at;
    in_.seekg(static_cast<std::streamoff>(at));
  }

  void Read(char* to, uint64_t bytes) {
    Need(bytes);
    if (!in_.read(to, static_cast<std::streamsize>(bytes))) Fail("it cannot be read");
    at_ += bytes;
  }

  template <class T>
  T Get() {
    T value{};
    Read(reinterpret_cast<char*>(&value), sizeof(value));
    return value;
  }

  std::string GetText() { return GetBytes(Get<uint32_t>()); }

  std::string GetBytes(uint32_t bytes) {
    Need(bytes);
    std::string text(bytes, '\0');
    Read(text.data(), bytes);
    return text;
  }

  void ReadHeader() {
    if (size_ < sizeof(kVdbMagic) || Get<int64_t>() != kVdbMagic) Fail("it does not begin like one");
    const auto version = Get<uint32_t>();
    if (version != openvdb::OPENVDB_FILE_VERSION) {
      Fail("its format is ", version, ", not ", uint32_t{openvdb::OPENVDB_FILE_VERSION});
    }
    Get<uint64_t>();  // the library's version
    if (Get<char>() != 1) Fail("it was written as a stream");
    GetBytes(kBytesOfUuid);
  }

  static void CheckValue(const FrameMetadata& metadata) {
    if (metadata.type == "string" || metadata.type == kDelayedLoadType) return;
    const auto known = std::find_if(std::begin(kSizes), std::end(kSizes),
                                    [&](const auto& size) { return size.first == metadata.type; });
    if (known == std::end(kSizes)) {
      Fail("its metadata ", Printable(metadata.name), " are of the type ", Printable(metadata.type));
    }
    if (metadata.value.size() != known->second) {
      Fail("its metadata ", Printable(metadata.name), " have ", metadata.value.size(), " bytes, not ", known->second);
    }
    const bool is_bool = known->second == 1;
    if (is_bool && static_cast<unsigned char>(metadata.value[0]) > 1) {
      Fail("its metadata ", Printable(metadata.name), " are neither true nor false");
    }
  }

  std::vector<FrameMetadata> ReadMetadata() {
    const auto count = Get<uint32_t>();
    Need(count * kLeastMetadata);
    std::vector<FrameMetadata> all;
    for (uint32_t n = 0; n < count; ++n) {
      FrameMetadata& each = all.emplace_back();
      each.name = GetText();
      each.type = GetText();
      each.value = GetText();
      CheckValue(each);
    }
    return all;
  }

  FrameGrid ReadGrid() {
    FrameGrid grid{};
    grid.name = GetText();
    grid.type = GetText();
    GetText();  // the grid that has its tree
    const auto begin = Get<int64_t>(), blocks = Get<int64_t>(), end = Get<int64_t>();
    const auto size = static_cast<int64_t>(size_);
    if (begin < static_cast<int64_t>(at_) || blocks < begin || end < blocks) Fail("its grid does not lie within it");
    if (end > size) Fail("it is cut short: ", size, " bytes of ", end);
    Seek(static_cast<uint64_t>(begin));
    Get<uint32_t>();  // compression
    grid.metadata = ReadMetadata();
    grid.transform_at = at_;
    grid.transform = GetText();
    // Else many grids could have the same metadata, and take memory for each.
    if (at_ > static_cast<uint64_t>(blocks)) Fail("the metadata of its grid reach into the tree");
    Seek(static_cast<uint64_t>(end));
    return grid;
  }

  std::istream& in_;
  const uint64_t size_;
  uint64_t at_ = 0;  // of `in_`; at most size_
};

}  // namespace

GridFrame ReadGridFrame(std::istream& in, uint64_t size) { return FrameReader(in, size).Read(); }

}  // namespace latvox::client
