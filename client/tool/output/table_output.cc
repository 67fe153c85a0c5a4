#include "client/tool/output/table_output.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <iterator>
#include <span>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/tool/output/field_columns.h"
#include "client/tool/output/npy_header.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

// Writes a header, then one row per voxel. The header holds the number of rows if the format needs it. Its length does
// not depend on the number, so it can be rewritten when the number is known.
class TableOutput : public Output {
 public:
  TableOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields)
      : fields_(fields), file_(std::move(file)) {}

  absl::Status Begin(const Accepted& accepted) final {
    accepted_ = accepted;
    return file_->Append(Header(0));
  }

  absl::Status Add(const BrickBatch& batch) final {
    size_t voxel = 0;
    for (const Brick& brick : batch.bricks) {
      rows_.clear();
      ForEachVoxel(brick, [&](const Vec3i& ijk) {
        AppendRow(ijk, accepted_.grid.ToWorld(ijk), batch.fields, voxel++, rows_);
        ++voxels_;
      });
      if (auto status = file_->Append(rows_); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary&) final {
    if (auto status = file_->Overwrite(0, Header(voxels_)); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() final { return file_->Commit(); }

 protected:
  const std::vector<Field> fields_;
  Accepted accepted_;

 private:
  using Fields = std::span<const FieldValues>;

  virtual std::string Header(uint64_t rows) const = 0;
  virtual void AppendRow(const Vec3i& ijk, const Vec3d& world, Fields fields, size_t voxel,
                         std::string& rows) const = 0;

  std::unique_ptr<AtomicFile> file_;
  std::string rows_;
  uint64_t voxels_ = 0;
};

template <class T>
void AppendBinary(const T& value, std::string& rows) {
  rows.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void AppendBinary(std::span<const FieldValues> fields, size_t voxel, std::string& rows) {
  for (const FieldValues& values : fields) rows.append(BytesAt(values, voxel), values.bytes_of_voxel());
}

// Joins one text for each component of each field.
std::string ForEachColumn(const std::vector<Field>& fields, const Accepted& accepted,
                          const std::function<std::string(Field field, const std::string& name)>& text_of) {
  std::string text;
  for (const Field field : fields) {
    for (const std::string& name : ColumnsOf(field, accepted)) text += text_of(field, name);
  }
  return text;
}

// Appends the components of a voxel's field, each with a comma behind it. Floats have 9 digits, which identify them.
void AppendText(const FieldValues& values, size_t voxel, std::string& rows) {
  const FieldFacts& facts = FactsOf(values.field);
  const size_t components = values.components();
  for (size_t n = voxel * components; n < (voxel + 1) * components; ++n) {
    char text[32];
    char* end = text;
    if (facts.type == NumberType::kFloat32) {
      end = std::to_chars(text, text + sizeof(text), values.As<float>()[n], std::chars_format::general, 9).ptr;
    } else {
      const int32_t number = facts.type == NumberType::kUint8    ? int32_t{values.As<uint8_t>()[n]}
                             : facts.type == NumberType::kUint16 ? int32_t{values.As<uint16_t>()[n]}
                                                                 : static_cast<int32_t>(values.As<uint32_t>()[n]);
      end = std::to_chars(text, text + sizeof(text), number).ptr;
    }
    *end++ = ',';
    rows.append(text, end);
  }
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
    for (size_t n = 0; n < fields_.size(); ++n) {
      std::vector<std::string> texts = names.Of(fields_[n]);
      if (texts.empty()) continue;
      std::transform(texts.begin(), texts.end(), texts.begin(), CsvField);
      names_.emplace_back(n, std::move(texts));
    }
  }

 private:
  std::string Header(uint64_t) const override {
    const auto column = [](Field, const std::string& name) { return absl::StrCat(",", name); };
    return absl::StrCat("i,j,k,x,y,z", ForEachColumn(fields_, accepted_, column),
                        absl::StrJoin(names_, "",
                                      [this](std::string* out, const auto& named) {
                                        absl::StrAppend(out, ",", NameOf(fields_[named.first]), "_name");
                                      }),
                        "\n");
  }

  void AppendRow(const Vec3i& ijk, const Vec3d& world, std::span<const FieldValues> fields, size_t voxel,
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
    rows.append(text, end);
    for (const FieldValues& values : fields) AppendText(values, voxel, rows);
    for (const auto& [n, texts] : names_) {
      const uint32_t number = NumberAt(fields[n], voxel);
      absl::StrAppend(&rows, number < texts.size() ? texts[number] : "", ",");
    }
    rows.back() = '\n';
  }

  std::vector<std::pair<size_t, std::vector<std::string>>> names_;  // place of the field, and texts by number
};

class NpyOutput final : public TableOutput {
 public:
  using TableOutput::TableOutput;

 private:
  std::string Header(uint64_t rows) const override {
    if (fields_.empty()) return NpyHeader("'<i4'", std::array<uint64_t, 2>{rows, 3});
    std::string type = "[('ijk', '<i4', (3,))";
    for (const Field field : fields_) {
      const std::vector<std::string> columns = ColumnsOf(field, accepted_);
      const auto append = [&](const std::string& name, size_t components) {
        absl::StrAppend(&type, ", ('", name, "', '", NumpyTypeOf(FactsOf(field).type), "'",
                        components > 1 ? absl::StrCat(", (", components, ",)") : "", ")");
      };
      if (!FactsOf(field).is_of_labels()) {
        append(NameOf(field), columns.size());
      } else {
        for (const std::string& column : columns) append(column, 1);
      }
    }
    return NpyHeader(type + "]", std::array<uint64_t, 1>{rows});
  }

  void AppendRow(const Vec3i& ijk, const Vec3d&, std::span<const FieldValues> fields, size_t voxel,
                 std::string& rows) const override {
    AppendBinary(ijk, rows);
    AppendBinary(fields, voxel, rows);
  }
};

class PlyOutput final : public TableOutput {
 public:
  using TableOutput::TableOutput;

 private:
  std::string Header(uint64_t rows) const override {
    const std::string count = absl::StrCat(rows);
    const auto property = [](Field field, const std::string& name) {
      const NumberType type = FactsOf(field).type;
      const char* const word = type == NumberType::kUint8    ? "uchar"
                               : type == NumberType::kUint16 ? "ushort"
                               : type == NumberType::kUint32 ? "int"
                                                             : "float";
      return absl::StrCat("property ", word, " ", name, "\n");
    };
    // The comment pads for the length of the number.
    return absl::StrCat("ply\nformat binary_little_endian 1.0\ncomment latvox voxel centers",
                        std::string(20 - count.size(), ' '), "\nelement vertex ", count,
                        "\nproperty double x\nproperty double y\nproperty double z\n"
                        "property int i\nproperty int j\nproperty int k\n",
                        ForEachColumn(fields_, accepted_, property), "end_header\n");
  }

  void AppendRow(const Vec3i& ijk, const Vec3d& world, std::span<const FieldValues> fields, size_t voxel,
                 std::string& rows) const override {
    AppendBinary(world, rows);
    AppendBinary(ijk, rows);
    AppendBinary(fields, voxel, rows);
  }
};

template <class Format>
std::unique_ptr<Output> NewFormat(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields) {
  return std::make_unique<Format>(std::move(file), fields);
}

constexpr std::pair<absl::string_view, decltype(&NewFormat<CsvOutput>)> kTableFormats[] = {
    {".csv", &NewFormat<CsvOutput>},
    {".npy", &NewFormat<NpyOutput>},
    {".ply", &NewFormat<PlyOutput>},
};

}  // namespace

std::unique_ptr<Output> NewTableOutput(absl::string_view extension, std::unique_ptr<AtomicFile> file,
                                       const std::vector<Field>& fields) {
  const auto is_it = [extension](const auto& format) { return format.first == extension; };
  return std::find_if(std::begin(kTableFormats), std::end(kTableFormats), is_it)->second(std::move(file), fields);
}

}  // namespace latvox::client
