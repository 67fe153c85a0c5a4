#include "client/tool/cli/shape_options.h"

#include <algorithm>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/field_list.h"

namespace latvox::client {
namespace {

constexpr int kMaxDim = 1 << 20, kMaxPad = 1 << 16;

WrongWord CheckDims(const std::string& text) {
  Vec3i dims;
  const auto is_wrong = [](int32_t n) { return n < 1 || n > kMaxDim; };
  if (ParseNumbers(text, dims) && std::none_of(dims.begin(), dims.end(), is_wrong)) return "";
  const std::string range = absl::StrCat("1 to ", kMaxDim);
  return {absl::StrCat("\"", text, "\" is not 3 whole numbers from ", range, " with commas between them"), text, range};
}

bool IsNpy(const std::string& path) { return HasExtension(path, {".npy"}); }

// Returns those of the formats that can hold the voxels, and what a .npy needs.
std::string Listed(const std::vector<std::string>& formats, OutputOptions options,
                   const std::optional<ToHold>& voxels) {
  options.dense_npy = true;
  std::vector<std::string> listed;
  const std::vector<std::string> able = voxels ? AbleFormats(*voxels, options) : formats;
  std::copy_if(formats.begin(), formats.end(), std::back_inserter(listed), [&able](const std::string& format) {
    return std::find(able.begin(), able.end(), format) != able.end();
  });
  const bool has_npy = std::find(listed.begin(), listed.end(), ".npy") != listed.end();
  return absl::StrCat(absl::StrJoin(listed, " "), has_npy ? "; for .npy, also --npy dense" : "");
}

}  // namespace

std::vector<OptionRow> ShapeRows(ShapeWords& words) {
  return {
      {.names = "--npy",
       .target = &words.npy,
       .help = "Content of a .npy: one row of coordinates per voxel, or a dense box of 0 and 1, or of one field",
       .words = {"coordinates", "dense"},
       .word_help = {"one row per voxel", "a box of 0 and 1, or of one field"},
       .standard = "coordinates"},
      {.names = "--array",
       .target = &words.array,
       .help =
           absl::StrCat("Fields of files whose format cannot hold all, or none; other files hold all. Such files are ",
                        absl::StrJoin(LimitedExtensions(), " "), "; .npy only with --npy dense"),
       .value = "NAME,...",
       .checks = {{CheckFieldList}},
       .standard = "all"},
      {.names = "--dims",
       .target = &words.dims,
       .help = absl::StrCat("Shape of dense arrays: this many points along i, j and k, with the voxels in the middle; "
                            "for ",
                            words.is_for_memory ? "dense() and " : "", absl::StrJoin(ShapedExtensions(), " ")),
       .value = "NI,NJ,NK",
       .checks = {{CheckDims}},
       .standard = "the voxels' box"},
      {.names = "--pad",
       .target = &words.pad,
       .help = "Empty points of dense arrays beyond the voxels' box, on each side",
       .value = "N",
       .checks = {Whole(0, kMaxPad)},
       .standard = "0"}};
}

void InterpretShape(const ShapeWords& words, const std::vector<std::string>& outputs, OutputOptions& options) {
  if (!words.npy.empty() && std::none_of(outputs.begin(), outputs.end(), IsNpy)) {
    Refuse("--npy: ", words.npy, " requires a .npy output, and --out names none");
  }
  options.dense_npy = words.npy == "dense";
  if (!words.dims.empty()) ParseNumbers(words.dims, options.shape.dims.emplace());
  if (!words.pad.empty()) ParseNumber(words.pad, options.shape.pad);
  if (!words.array.empty()) options.array = ParseFieldList(words.array);
}

void CheckShape(const ShapeWords& words, const std::vector<std::string>& outputs, const OutputOptions& options,
                const std::optional<ToHold>& voxels) {
  if (words.is_for_memory) return;
  if (options.array) CheckArrayOutput(outputs, options, voxels);
  const auto has_shape = [&](const std::string& path) {
    return HasExtension(path, ShapedExtensions()) && (options.dense_npy || !IsNpy(path));
  };
  if (options.shape == BoxShape() || std::any_of(outputs.begin(), outputs.end(), has_shape)) return;
  Refuse(words.dims.empty() ? "--pad" : "--dims",
         ": needs an output with a shape: ", Listed(ShapedExtensions(), options, voxels));
}

void CheckArrayOutput(const std::vector<std::string>& outputs, const OutputOptions& options,
                      const std::optional<ToHold>& voxels) {
  const auto is_limited = [&options](const std::string& path) { return IsLimited(path, options); };
  if (std::any_of(outputs.begin(), outputs.end(), is_limited)) return;
  const std::string able = Listed(LimitedExtensions(), options, voxels);
  if (!able.empty()) Refuse("--array: needs an output that cannot hold all fields: ", able);
  Refuse("--array: needs an output that cannot hold all fields, and no such format can hold ",
         JoinNames(*options.array));
}

void CheckArray(const std::vector<Field>& fields, const OutputOptions& options) {
  for (const Field field : options.array.value_or(std::vector<Field>())) {
    if (!CarriesField(fields, field)) Refuse("--array: ", NameOf(field), " is not among --fields");
  }
}

}  // namespace latvox::client
