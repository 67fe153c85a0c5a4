#include "client/tool/output/image_output.h"

#include <algorithm>
#include <cstring>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/internal/file_error.h"
#include "client/tool/output/deflater.h"
#include "client/tool/output/dense_fields.h"
#include "client/tool/output/image_header.h"

namespace latvox::client {
namespace {

// A component of an array, as an array.
DenseArray Component(const DenseArray& array, size_t component) {
  const size_t bytes = array.empty.size() / array.components;
  const auto put = [whole = array.put, size = array.empty.size(), bytes, component](uint64_t n, char* to) {
    std::string element(size, '\0');
    whole(n, element.data());
    element.copy(to, bytes, component * bytes);
  };
  return {array.name, array.type, 1, array.empty.substr(0, bytes), put};
}

// Returns an array of labels that are one more, and 0 where there is no voxel. Other numbers remain; integers are 0
// where there is no voxel.
DenseArray AsLabels(const DenseArray& array) {
  if (array.type != NumberType::kUint32) return array;
  const std::string empty(array.empty.size(), '\0');
  if (!array.is_label) return {array.name, array.type, array.components, empty, array.put};
  const auto put = [before = array.put, components = array.components](uint64_t n, char* to) {
    before(n, to);
    for (size_t component = 0; component < components; ++component, to += sizeof(int32_t)) {
      int32_t number = 0;
      std::memcpy(&number, to, sizeof(number));
      ++number;
      std::memcpy(to, &number, sizeof(number));
    }
  };
  return {array.name, array.type, array.components, empty, put};
}

// MetaIO's readers take a % for a pattern of numbers and LIST for a list of names. They skip spaces at the start.
bool CanNameData(const std::string& name) {
  const auto is_wrong = [](unsigned char c) { return c < ' ' || c == '%'; };
  return !absl::StartsWith(name, " ") && !absl::StartsWith(name, "LIST") && std::ranges::none_of(name, is_wrong);
}

class ImageOutput final : public Output {
 public:
  ImageOutput(std::unique_ptr<AtomicFile> file, ImageFormat format, const std::vector<Field>& fields,
              const BoxShape& shape)
      : file_(std::move(file)),
        format_(format),
        fields_(fields, DenseOrder::kFirstFastest, shape, kOneElement, /*are_joined=*/true) {}

  void SetNames(const CarriedNames& names) override {
    if (fields_.values().size() == 1) segments_ = names.Of(fields_.values()[0].field);
  }

  absl::Status Begin(const Accepted& accepted) override {
    if (auto status = fields_.Begin(accepted, file_->target()); !status.ok()) return status;
    if (HasLinks()) neighbors_ = accepted.neighbors;
    if (format_ != ImageFormat::kMetaPair) return absl::OkStatus();
    const std::filesystem::path data_path = std::filesystem::path(file_->target()).replace_extension(".raw");
    const std::string name = data_path.filename().string();
    if (!CanNameData(name)) {
      return WithFile(absl::InvalidArgumentError(absl::StrCat(
                          file_->target(), ": readers of .mhd take this name for a list or a pattern of files")),
                      "--out", file_->target(), "a name without %, control characters, LIST or spaces at its start");
    }
    auto data = AtomicFile::Create(data_path.string(), AtomicFile::Form::kUnnamed, file_->cancellation());
    if (!data.ok()) return data.status();
    data_ = *std::move(data);
    return absl::OkStatus();
  }

  absl::Status Add(const BrickBatch& batch) override { return fields_.Add(batch); }

  absl::Status Finish(const Summary&) override {
    if (auto status = fields_.Finish(); !status.ok()) return status;
    std::vector<DenseArray> arrays = fields_.Arrays();
    for (DenseArray& each : arrays) each = AsLabels(each);
    const bool is_list = arrays.size() > 2 || HasLinks();
    const DenseArray array = Joined(std::move(arrays));
    const ImageFacts image = {fields_.grid().basis,
                              fields_.corner(),
                              fields_.box().shape(),
                              array.type,
                              array.components,
                              is_nifti() ? NameOfField() : array.name,
                              segments_,
                              is_list,
                              neighbors_};
    if (auto status = Write(image, array); !status.ok()) return status;
    if (data_ != nullptr) {
      if (auto status = data_->Sync(); !status.ok()) return status;
    }
    return file_->Sync();
  }

  // The data come first: a header never names data that are not there.
  absl::Status Commit() override {
    if (data_ != nullptr) {
      if (auto status = data_->Commit(); !status.ok()) return status;
    }
    return file_->Commit();
  }

 private:
  bool HasLinks() const {
    const auto is_of_links = [](const FieldValues& values) { return FactsOf(values.field).is_of_links(); };
    return std::ranges::any_of(fields_.values(), is_of_links);
  }

  // Returns that of the only field: NIfTI has no room for the names of all labels.
  std::string NameOfField() const { return fields_.values().empty() ? "data" : NameOf(fields_.values()[0].field); }

  bool is_nifti() const { return format_ == ImageFormat::kNifti || format_ == ImageFormat::kNiftiGzip; }

  absl::Status Write(const ImageFacts& image, const DenseArray& array) {
    switch (format_) {
      case ImageFormat::kNrrd: {
        if (auto status = file_->Append(NrrdHeader(image)); !status.ok()) return status;
        return AppendDeflated(Rows(array), StreamForm::kGzip, *file_).status();
      }
      case ImageFormat::kMetaImage: {
        if (auto status = file_->Append(MetaImageHeader(image, 0)); !status.ok()) return status;
        const auto bytes = AppendDeflated(Rows(array), StreamForm::kZlib, *file_);
        if (!bytes.ok()) return bytes.status();
        return file_->Overwrite(0, MetaImageHeader(image, *bytes));
      }
      case ImageFormat::kMetaPair: {
        const std::string name = std::filesystem::path(data_->target()).filename().string();
        if (auto status = file_->Append(MetaImageHeader(image, name)); !status.ok()) return status;
        return AppendAll(Rows(array), *data_);
      }
      case ImageFormat::kNifti:
        return AppendAll(Rows(array, NiftiHeader(image)), *file_);
      case ImageFormat::kNiftiGzip:
        break;
    }
    return AppendDeflated(Rows(array, NiftiHeader(image)), StreamForm::kGzip, *file_).status();
  }

  static absl::Status AppendAll(const NextChunk& next, AtomicFile& file) {
    std::string chunk;
    for (next(chunk); !chunk.empty(); next(chunk)) {
      if (auto status = file.Append(chunk); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  // Returns the bytes of the array, after others.
  NextChunk Rows(const DenseArray& array, std::string before = "") {
    const bool by_component = is_nifti() && array.components > 1 && array.type != NumberType::kUint8;
    const auto parts = std::make_shared<std::deque<DenseRows>>();
    for (size_t n = 0; n < (by_component ? array.components : 1); ++n) {
      const DenseArray part = by_component ? Component(array, n) : array;
      parts->emplace_back(fields_.box(), part.empty, part.put);
    }
    return [parts, before = std::move(before)](std::string& chunk) mutable {
      chunk = std::exchange(before, {});
      while (chunk.empty() && !parts->empty()) {
        parts->front().Next(chunk);
        if (chunk.empty()) parts->pop_front();
      }
    };
  }

  std::unique_ptr<AtomicFile> file_, data_;  // data_: of kMetaPair
  const ImageFormat format_;
  DenseFields fields_;
  std::vector<std::string> segments_;  // names of its numbers
  std::vector<Vec3i> neighbors_;       // for fields of links
};

}  // namespace

std::unique_ptr<Output> NewImageOutput(std::unique_ptr<AtomicFile> file, ImageFormat format,
                                       const std::vector<Field>& fields, const BoxShape& shape) {
  return std::make_unique<ImageOutput>(std::move(file), format, fields, shape);
}

}  // namespace latvox::client
