#include "client/tool/output/table_output.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <iterator>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/tool/output/npy_header.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

// Writes a header, then one row per voxel. The header holds the number of rows if the format needs it. Its length does
// not depend on the number, so it can be rewritten when the number is known.
class TableOutput : public Output {
 public:
  TableOutput(std::unique_ptr<AtomicFile> file, const TableColumns& columns)
      : columns_(columns), file_(std::move(file)) {}

  absl::Status Begin(const Accepted& accepted) final {
    grid_ = accepted.grid;
    return file_->Append(Header(0));
  }

  absl::Status Add(const BrickBatch& batch) final {
    const float* distance = batch.values.data();
    const uint32_t* numbers = batch.attributes.data();
    for (const Brick& brick : batch.bricks) {
      rows_.clear();
      ForEachVoxel(brick, [this, &distance, &numbers](const Vec3i& ijk) {
        AppendRow(ijk, grid_.ToWorld(ijk), columns_.distances ? distance++ : nullptr, numbers, rows_);
        numbers += columns_.attributes.size();
        ++voxels_;
      });
      if (auto status = file_->Append(rows_); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary&) final {
    if (auto status = file_->WriteAtStart(Header(voxels_)); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() final { return file_->Commit(); }

 protected:
  const TableColumns columns_;

 private:
  virtual std::string Header(uint64_t rows) const = 0;
  // `distance` is null without distances. `numbers` has one number per attribute.
  virtual void AppendRow(const Vec3i& ijk, const Vec3d& world, const float* distance, const uint32_t* numbers,
                         std::string& rows) const = 0;

  std::unique_ptr<AtomicFile> file_;
  GridTransform grid_;
  std::string rows_;
  uint64_t voxels_ = 0;
};

template <class T>
void AppendBinary(const T& value, std::string& rows) {
  rows.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

// Returns the three components of a color.
std::array<uint8_t, 3> ColorOf(uint32_t number) {
  return {static_cast<uint8_t>(number >> 16), static_cast<uint8_t>(number >> 8), static_cast<uint8_t>(number)};
}

// Appends integers of 32 bits, and colors as three bytes.
void AppendBinary(const std::vector<Attribute>& attributes, const uint32_t* numbers, std::string& rows) {
  for (const Attribute attribute : attributes) {
    const uint32_t number = *numbers++;
    attribute == Attribute::kColor ? AppendBinary(ColorOf(number), rows) : AppendBinary(number, rows);
  }
}

// Joins one text for each attribute.
std::string ForEach(const std::vector<Attribute>& attributes, const char* of_color,
                    const std::function<std::string(const char* name)>& of_number) {
  std::string text;
  for (const Attribute attribute : attributes) {
    text += attribute == Attribute::kColor ? of_color : of_number(NameOf(attribute));
  }
  return text;
}

// Returns the text as a field: within quotes if it needs them, without line ends and other control characters.
std::string CsvField(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 0x7F; }, ' ');
  if (text.find_first_of(",\"") == std::string::npos) return text;
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\"", "\"\""}}), "\"");
}

class CsvOutput final : public TableOutput {
 public:
  using TableOutput::TableOutput;

  void SetNames(const CarriedNames& names) override {
    for (size_t n = 0; n < columns_.attributes.size(); ++n) {
      std::vector<std::string> fields = names.Of(columns_.attributes[n]);
      if (fields.empty()) continue;
      std::transform(fields.begin(), fields.end(), fields.begin(), CsvField);
      names_.emplace_back(n, std::move(fields));
    }
  }

 private:
  std::string Header(uint64_t) const override {
    const auto column = [](const char* name) { return absl::StrCat(",", name); };
    return absl::StrCat("i,j,k,x,y,z", columns_.distances ? ",distance" : "",
                        ForEach(columns_.attributes, ",red,green,blue", column),
                        absl::StrJoin(names_, "",
                                      [this](std::string* out, const auto& named) {
                                        absl::StrAppend(out, ",", NameOf(columns_.attributes[named.first]), "_name");
                                      }),
                        "\n");
  }

  void AppendRow(const Vec3i& ijk, const Vec3d& world, const float* distance, const uint32_t* numbers,
                 std::string& rows) const override {
    char text[192];
    char* end = text;
    for (const int32_t index : ijk) {
      end = std::to_chars(end, text + sizeof(text), index).ptr;
      *end++ = ',';
    }
    for (size_t m = 0; m < 3; ++m) {
      // Equals printf's %.17g in the C locale, in any locale.
      end = std::to_chars(end, text + sizeof(text), world[m], std::chars_format::general, 17).ptr;
      *end++ = ',';
    }
    if (distance != nullptr) {
      end = std::to_chars(end, text + sizeof(text), *distance, std::chars_format::general, 9).ptr;
      *end++ = ',';
    }
    rows.append(text, end);
    for (size_t n = 0; n < columns_.attributes.size(); ++n) {
      if (columns_.attributes[n] == Attribute::kColor) {
        absl::StrAppend(&rows, absl::StrJoin(ColorOf(numbers[n]), ","), ",");
      } else {
        absl::StrAppend(&rows, numbers[n], ",");
      }
    }
    for (const auto& [n, fields] : names_)
      absl::StrAppend(&rows, numbers[n] < fields.size() ? fields[numbers[n]] : "", ",");
    rows.back() = '\n';
  }

  std::vector<std::pair<size_t, std::vector<std::string>>> names_;  // place of the attribute, and fields by number
};

class NpyOutput final : public TableOutput {
 public:
  using TableOutput::TableOutput;

 private:
  std::string Header(uint64_t rows) const override {
    if (!columns_.distances && columns_.attributes.empty()) {
      return NpyHeader("'<i4'", std::array<uint64_t, 2>{rows, 3});
    }
    const auto field = [](const char* name) { return absl::StrCat(", ('", name, "', '<i4')"); };
    const std::string type = absl::StrCat("[('ijk', '<i4', (3,))", columns_.distances ? ", ('distance', '<f4')" : "",
                                          ForEach(columns_.attributes, ", ('color', 'u1', (3,))", field), "]");
    return NpyHeader(type, std::array<uint64_t, 1>{rows});
  }

  void AppendRow(const Vec3i& ijk, const Vec3d&, const float* distance, const uint32_t* numbers,
                 std::string& rows) const override {
    AppendBinary(ijk, rows);
    if (distance != nullptr) AppendBinary(*distance, rows);
    AppendBinary(columns_.attributes, numbers, rows);
  }
};

class PlyOutput final : public TableOutput {
 public:
  using TableOutput::TableOutput;

 private:
  std::string Header(uint64_t rows) const override {
    const std::string count = absl::StrCat(rows);
    const auto property = [](const char* name) { return absl::StrCat("property int ", name, "\n"); };
    // The comment pads for the length of the number.
    return absl::StrCat(
        "ply\nformat binary_little_endian 1.0\ncomment latvox voxel centers", std::string(20 - count.size(), ' '),
        "\nelement vertex ", count,
        "\nproperty double x\nproperty double y\nproperty double z\n"
        "property int i\nproperty int j\nproperty int k\n",
        columns_.distances ? "property float distance\n" : "",
        ForEach(columns_.attributes, "property uchar red\nproperty uchar green\nproperty uchar blue\n", property),
        "end_header\n");
  }

  void AppendRow(const Vec3i& ijk, const Vec3d& world, const float* distance, const uint32_t* numbers,
                 std::string& rows) const override {
    AppendBinary(world, rows);
    AppendBinary(ijk, rows);
    if (distance != nullptr) AppendBinary(*distance, rows);
    AppendBinary(columns_.attributes, numbers, rows);
  }
};

template <class Format>
std::unique_ptr<Output> NewFormat(std::unique_ptr<AtomicFile> file, const TableColumns& columns) {
  return std::make_unique<Format>(std::move(file), columns);
}

constexpr std::pair<absl::string_view, decltype(&NewFormat<CsvOutput>)> kTableFormats[] = {
    {".csv", &NewFormat<CsvOutput>},
    {".npy", &NewFormat<NpyOutput>},
    {".ply", &NewFormat<PlyOutput>},
};

}  // namespace

std::unique_ptr<Output> NewTableOutput(absl::string_view extension, std::unique_ptr<AtomicFile> file,
                                       const TableColumns& columns) {
  const auto is_it = [extension](const auto& format) { return format.first == extension; };
  return std::find_if(std::begin(kTableFormats), std::end(kTableFormats), is_it)->second(std::move(file), columns);
}

}  // namespace latvox::client
