#include "client/tool/inspect/array_facts.h"

#include <zip.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/tool/inspect/extent.h"
#include "latvox/types.h"

namespace latvox::client {
namespace {

// The facts in the header of a .npy.
struct Array {
  std::string type;             // as Python writes it
  std::vector<uint64_t> shape;  // product below 2^62
  uint64_t elements = 1;
  size_t element_bytes = 0;
  bool has_ijk = false;  // elements begin with three int32, or are rows of them
};

// Returns the text between two others, or nothing.
std::optional<absl::string_view> Between(absl::string_view text, absl::string_view before, absl::string_view after) {
  const size_t begin = text.find(before);
  if (begin == absl::string_view::npos) return std::nullopt;
  text.remove_prefix(begin + before.size());
  const size_t end = text.find(after);
  if (end == absl::string_view::npos) return std::nullopt;
  return text.substr(0, end);
}

// Returns the bytes of a type such as "<f4", or 0.
size_t BytesOf(absl::string_view type) {
  constexpr uint32_t kMost = 16;
  uint32_t bytes = 0;
  if (type.size() < 3 || !absl::SimpleAtoi(type.substr(2), &bytes) || bytes > kMost) return 0;
  return bytes;
}

// Adds up the fields of a type such as [('ijk', '<i4', (3,)), ('distance', '<f4')]. Returns 0 if it is none.
size_t BytesOfFields(absl::string_view type) {
  size_t bytes = 0;
  for (absl::string_view field : absl::StrSplit(type, "('", absl::SkipEmpty())) {
    const auto word = Between(field, "', '", "'");
    if (!word) continue;  // the bracket
    uint32_t count = 1;
    if (const auto many = Between(field, ", (", ",)"); many && !absl::SimpleAtoi(*many, &count)) return 0;
    if (BytesOf(*word) == 0 || count > 1024) return 0;
    bytes += BytesOf(*word) * count;
  }
  return bytes;
}

absl::StatusOr<Array> ReadHeader(ByteSource& source) {
  constexpr size_t kMostElement = 1024;
  std::array<char, 10> head;
  if (auto status = source.Read(head.data(), head.size()); !status.ok()) return status;
  if (absl::string_view(head.data(), 8) != absl::string_view("\x93NUMPY\x01\x00", 8)) {
    return source.Bad("is not a .npy of version 1.0");
  }
  std::string text(static_cast<uint8_t>(head[8]) | size_t{static_cast<uint8_t>(head[9])} << 8, '\0');
  if (auto status = source.Read(text.data(), text.size()); !status.ok()) return status;
  const auto type = Between(text, "'descr': ", ", 'fortran_order': False"), shape = Between(text, "'shape': (", ")");
  if (!type || !shape) return source.Bad("has no header with descr and shape in C order");
  Array array;
  array.type = std::string(*type);
  for (const absl::string_view side : absl::StrSplit(*shape, ", ", absl::SkipEmpty())) {
    uint64_t number = 0;
    if (!absl::SimpleAtoi(absl::StripSuffix(side, ","), &number) || number > uint64_t{1} << 40 ||
        array.elements > uint64_t{1} << 40 || array.elements * std::max<uint64_t>(number, 1) > uint64_t{1} << 40) {
      return source.Bad("shape (", *shape, ") is not read");
    }
    array.shape.push_back(number);
    array.elements *= number;
  }
  const bool fields = absl::StartsWith(*type, "[");
  array.element_bytes = fields ? BytesOfFields(*type) : BytesOf(absl::StripSuffix(absl::StripPrefix(*type, "'"), "'"));
  if (array.element_bytes == 0 || array.element_bytes > kMostElement) return source.Bad("type ", *type, " is not read");
  array.has_ijk = fields ? absl::StartsWith(*type, "[('ijk', '<i4', (3,))")
                         : *type == "'<i4'" && array.shape.size() == 2 && array.shape[1] == 3;
  return array;
}

// Calls visit(bytes, count) for pieces of the array's elements.
absl::Status ForEachElement(ByteSource& source, const Array& array,
                            const std::function<void(const char* elements, size_t count)>& visit) {
  constexpr size_t kPiece = 3 * 4096;  // whole rows of three
  std::string bytes(kPiece * array.element_bytes, '\0');
  for (uint64_t left = array.elements; left > 0;) {
    const size_t count = std::min<uint64_t>(left, kPiece);
    if (auto status = source.Read(bytes.data(), count * array.element_bytes); !status.ok()) return status;
    visit(bytes.data(), count);
    left -= count;
  }
  return source.CheckEnd();
}

// Counts the voxels of a dense array: elements that are not 0, or for distances, numbers.
absl::StatusOr<uint64_t> CountDense(ByteSource& source, const Array& array) {
  uint64_t voxels = 0;
  const bool distances = array.type == "'<f4'";
  const absl::Status status = ForEachElement(source, array, [&](const char* elements, size_t count) {
    for (size_t n = 0; n < count; ++n) {
      float distance = 0;
      if (distances) std::memcpy(&distance, elements + 4 * n, 4);
      voxels += distances ? !std::isnan(distance) : elements[n] != 0;
    }
  });
  if (!status.ok()) return status;
  return voxels;
}

// Reads the three lattice coordinates of each row.
absl::Status ReadRows(ByteSource& source, const Array& array, Json& facts) {
  Extent<int32_t> box;
  const size_t row = array.type == "'<i4'" ? 12 : array.element_bytes;
  const absl::Status status = ForEachElement(source, array, [&](const char* elements, size_t count) {
    for (const char* at = elements; at < elements + count * array.element_bytes; at += row) {
      Vec3i ijk;
      std::memcpy(ijk.data(), at, sizeof(ijk));
      box.Add(ijk);
    }
  });
  if (!status.ok()) return status;
  facts["voxels"] = array.shape.empty() ? 0 : array.shape[0];
  facts["index_box"] = box.ToJson(1);
  return absl::OkStatus();
}

bool IsDense(const Array& array) { return array.shape.size() == 3 && (array.type == "'|u1'" || array.type == "'<f4'"); }

class MemberSource final : public ByteSource {
 public:
  MemberSource(const std::string& name, zip_file_t* file) : ByteSource(name), file_(file) {}
  ~MemberSource() override { zip_fclose(file_); }

  absl::StatusOr<size_t> ReadSome(char* to, size_t count) override {
    size_t all = 0;
    while (all < count) {
      const zip_int64_t got = zip_fread(file_, to + all, count - all);
      if (got < 0) return Bad("is damaged (", zip_file_strerror(file_), ")");
      if (got == 0) break;
      all += static_cast<size_t>(got);
    }
    return all;
  }

 private:
  zip_file_t* const file_;
};

// Adds what one member says.
absl::Status AddMember(const std::string& name, MemberSource& member, Json& facts) {
  const auto array = ReadHeader(member);
  if (!array.ok()) return array.status();
  facts["arrays"][name] = {{"type", array->type}, {"shape", array->shape}};
  constexpr size_t kMostNumbers = 16;
  if (name == "neighbor" && array->shape.size() == 1) facts["links"] = array->shape[0];
  if (name == "data" && IsDense(*array)) {
    if (array->elements > uint64_t{1} << 32) return member.Bad("has ", array->elements, " elements, more than 2^32");
    const auto voxels = CountDense(member, *array);
    if (!voxels.ok()) return voxels.status();
    facts["voxels"] = *voxels;
  } else if (array->type == "'<f8'" && array->elements <= kMostNumbers) {
    std::vector<double> numbers(array->elements);
    if (auto status = member.Read(numbers.data(), 8 * numbers.size()); !status.ok()) return status;
    facts[name] = numbers;
  } else if (name == "index_min" && array->type == "'<i4'" && array->elements == 3) {
    Vec3i low;
    if (auto status = member.Read(low.data(), sizeof(low)); !status.ok()) return status;
    facts[name] = low;
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Json> NpyFacts(FileSource& file) {
  const auto array = ReadHeader(file);
  if (!array.ok()) return array.status();
  Json facts = {{"type", array->type}, {"shape", array->shape}};
  if (file.size() - file.at() != array->elements * array->element_bytes) {
    return file.Bad("has ", file.size() - file.at(), " bytes of elements, not ",
                    array->elements * array->element_bytes);
  }
  if (array->has_ijk) {
    if (auto status = ReadRows(file, *array, facts); !status.ok()) return status;
  } else if (IsDense(*array) && array->element_bytes == 1) {
    const auto voxels = CountDense(file, *array);
    if (!voxels.ok()) return voxels.status();
    facts["voxels"] = *voxels;
  }
  return facts;
}

absl::StatusOr<Json> NpzFacts(const std::string& path) {
  constexpr zip_int64_t kMostMembers = 1000;
  int error = 0;
  zip_t* const archive = zip_open(path.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &error);
  if (archive == nullptr) return absl::InvalidArgumentError(absl::StrCat(path, ": is not a complete zip archive"));
  const absl::Cleanup discard = [archive] { zip_discard(archive); };
  const zip_int64_t members = zip_get_num_entries(archive, 0);
  if (members > kMostMembers) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": has ", members, " members, more than ", kMostMembers));
  }
  Json facts = {{"arrays", Json::object()}};
  for (zip_int64_t n = 0; n < members; ++n) {
    const auto number = static_cast<zip_uint64_t>(n);
    const std::string name = zip_get_name(archive, number, 0);
    zip_file_t* const file = zip_fopen_index(archive, number, 0);
    if (file == nullptr) return absl::InvalidArgumentError(absl::StrCat(path, ": ", name, " cannot be read"));
    MemberSource member(absl::StrCat(path, ": ", name), file);
    if (auto status = AddMember(std::string(absl::StripSuffix(name, ".npy")), member, facts); !status.ok()) {
      return status;
    }
  }
  return facts;
}

}  // namespace latvox::client
