#include "client/tool/output/image_header.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/internal/vec3.h"

namespace latvox::client {
namespace {

// The names of a number type in each format.
struct TypeNames {
  const char *nrrd, *meta_image;
  int16_t nifti, bits;
};

TypeNames NamesOf(NumberType type) {
  if (type == NumberType::kUint8) return {"uint8", "MET_UCHAR", 2, 8};
  if (type == NumberType::kUint16) return {"uint16", "MET_USHORT", 512, 16};
  if (type == NumberType::kUint32) return {"int32", "MET_INT", 8, 32};
  return {"float", "MET_FLOAT", 16, 32};
}

std::string Numbers(const Vec3d& v, const char* separator) {
  return absl::StrJoin(v, separator, [](std::string* out, double x) { absl::StrAppendFormat(out, "%.17g", x); });
}

// Returns "-1,0,1 0,0,1": lattice vectors.
std::string Vectors(const std::vector<Vec3i>& vectors) {
  return absl::StrJoin(vectors, " ", [](std::string* out, const Vec3i& v) { *out += absl::StrJoin(v, ","); });
}

std::string MetaImageHead(const ImageFacts& image, const std::string& compression, const std::string& data_file) {
  const Vec3d* const steps[] = {&image.basis.a, &image.basis.b, &image.basis.c};
  std::string rows;
  Vec3d spacing{};
  for (size_t n = 0; n < 3; ++n) {
    spacing[n] = Length(*steps[n]);
    absl::StrAppend(&rows, n == 0 ? "" : " ", Numbers(Unit(*steps[n]), " "));
  }
  const std::string comment =
      image.neighbors.empty() ? "" : absl::StrCat("Comment = neighbors ", Vectors(image.neighbors), "\n");
  return absl::StrCat("ObjectType = Image\nNDims = 3\n", comment, "BinaryData = True\nBinaryDataByteOrderMSB = False\n",
                      compression, "TransformMatrix = ", rows, "\nOffset = ", Numbers(image.corner, " "),
                      "\nCenterOfRotation = 0 0 0\nElementSpacing = ", Numbers(spacing, " "),
                      "\nDimSize = ", absl::StrJoin(image.shape, " "), "\nElementNumberOfChannels = ", image.components,
                      "\nElementType = ", NamesOf(image.type).meta_image, "\nElementDataFile = ", data_file, "\n");
}

// Where NIfTI's two versions have the fields that are written.
struct NiftiLayout {
  int32_t size;  // of the header without the flag of extensions
  size_t magic_at, dim, intent_code, datatype, bitpix, pixdim, vox_offset, sform_code, srow, intent_name;
  std::string_view magic;
};
constexpr NiftiLayout kNifti1 = {348, 344, 40, 68, 70, 72, 76, 108, 254, 280, 328, {"n+1\0", 4}};
constexpr NiftiLayout kNifti2 = {540, 4, 16, 504, 12, 14, 104, 168, 348, 400, 508, {"n+2\0\r\n\x1A\n", 8}};

// Side, Real and Code are the types of sides, of numbers, and of codes except that of the data. The offset of the data
// is a number in version 1, and has the type of sides in version 2.
template <class Side, class Real, class Code>
std::string HeaderOf(const NiftiLayout& layout, const ImageFacts& image) {
  constexpr Code kVector = 1007, kAlignedToAnother = 2;
  constexpr int16_t kRgb24 = 128;
  const auto bytes = static_cast<size_t>(layout.size) + 4;
  std::string header(bytes, '\0');
  const auto put = [&header](size_t at, const auto& value) { std::memcpy(&header[at], &value, sizeof(value)); };
  const bool is_color = image.type == NumberType::kUint8 && image.components == 3;
  const bool is_vector = image.components > 1 && !is_color;
  std::array<Side, 8> sides;
  std::array<Real, 8> spacing;
  sides.fill(1);
  spacing.fill(1);
  sides[0] = is_vector ? 5 : 3;
  const Vec3d* const steps[] = {&image.basis.a, &image.basis.b, &image.basis.c};
  for (size_t n = 0; n < 3; ++n) {
    sides[n + 1] = static_cast<Side>(image.shape[n]);
    spacing[n + 1] = static_cast<Real>(Length(*steps[n]));
    std::array<Real, 4> row;
    for (size_t m = 0; m < 3; ++m) row[m] = static_cast<Real>((*steps[m])[n]);
    row[3] = static_cast<Real>(image.corner[n]);
    put(layout.srow + n * sizeof(row), row);  // srow_x, srow_y, srow_z
  }
  if (is_vector) sides[5] = static_cast<Side>(image.components);
  const TypeNames names = NamesOf(image.type);
  put(0, layout.size);
  put(layout.dim, sides);
  if (is_vector) put(layout.intent_code, kVector);
  put(layout.datatype, is_color ? kRgb24 : names.nifti);
  put(layout.bitpix, static_cast<int16_t>(is_color ? 3 * names.bits : names.bits));
  put(layout.pixdim, spacing);
  if constexpr (std::is_same_v<Real, float>) {
    put(layout.vox_offset, static_cast<float>(bytes));
  } else {
    put(layout.vox_offset, static_cast<int64_t>(bytes));
  }
  put(layout.sform_code, kAlignedToAnother);
  header.replace(layout.intent_name, image.name.size(), image.name);  // at most 15 bytes
  header.replace(layout.magic_at, layout.magic.size(), layout.magic);
  return header;
}

// Returns how far the sform of NIfTI-1 moves a corner of the box: its numbers are floats.
double GreatestShift(const ImageFacts& image) {
  const auto lost = [](double x) { return double{static_cast<float>(x)} - x; };
  double most = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3d shift{};
    for (size_t n = 0; n < 3; ++n) {
      shift[n] = lost(image.corner[n]);
      const Vec3d* const steps[] = {&image.basis.a, &image.basis.b, &image.basis.c};
      for (size_t m = 0; m < 3; ++m) {
        const double index = (corner >> m & 1) != 0 ? static_cast<double>(image.shape[m] - 1) : 0;
        shift[n] += index * lost((*steps[m])[n]);
      }
    }
    most = std::max(most, Length(shift));
  }
  return most;
}

// Returns lines of keys and values for the labels with names. Slicer numbers segments without gaps.
std::string SegmentLines(const std::vector<std::string>& names) {
  std::string lines;
  size_t segment = 0;
  for (size_t n = 0; n < names.size(); ++n) {
    if (names[n].empty()) continue;
    std::string name = absl::StrReplaceAll(names[n], {{"\\", "\\\\"}});
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == 0x7F; }, ' ');
    const std::string key = absl::StrCat("Segment", segment++, "_");
    absl::StrAppend(&lines, key, "ID:=Segment_", n + 1, "\n", key, "LabelValue:=", n + 1, "\n", key, "Layer:=0\n", key,
                    "Name:=", name, "\n");
  }
  return lines;
}

}  // namespace

std::string NrrdHeader(const ImageFacts& image) {
  const auto& [a, b, c] = image.basis;
  const bool many = image.components > 1;
  const std::string first = absl::StrCat(image.components, " ");
  const std::string neighbors =
      image.neighbors.empty() ? "" : absl::StrCat("neighbors:=", Vectors(image.neighbors), "\n");
  return absl::StrCat("NRRD0005\ncontent: ", image.name, "\ntype: ", NamesOf(image.type).nrrd,
                      "\ndimension: ", many ? 4 : 3, "\nspace: left-posterior-superior\nsizes: ", many ? first : "",
                      absl::StrJoin(image.shape, " "), "\nspace directions: ", many ? "none " : "", "(",
                      Numbers(a, ","), ") (", Numbers(b, ","), ") (", Numbers(c, ","), ")\nkinds: ",
                      image.is_list                              ? "list "
                      : image.type == NumberType::kUint8 && many ? "RGB-color "
                      : many                                     ? "vector "
                                                                 : "",
                      "domain domain domain\nendian: little\nencoding: gzip\nspace origin: (",
                      Numbers(image.corner, ","), ")\n", neighbors, SegmentLines(image.segments), "\n");
}

std::string MetaImageHeader(const ImageFacts& image, uint64_t compressed_bytes) {
  return MetaImageHead(image, absl::StrFormat("CompressedData = True\nCompressedDataSize = %020d\n", compressed_bytes),
                       "LOCAL");
}

std::string MetaImageHeader(const ImageFacts& image, const std::string& data_file) {
  return MetaImageHead(image, "CompressedData = False\n", data_file);
}

bool NeedsNifti2(const ImageFacts& image) {
  constexpr uint64_t kMost = std::numeric_limits<int16_t>::max();
  constexpr double kMostShift = 1e-3;  // of a step
  if (*std::max_element(image.shape.begin(), image.shape.end()) > kMost) return true;
  const auto& [a, b, c] = image.basis;
  return GreatestShift(image) > kMostShift * std::min({Length(a), Length(b), Length(c)});
}

std::string NiftiHeader(const ImageFacts& image) {
  return NeedsNifti2(image) ? HeaderOf<int64_t, double, int32_t>(kNifti2, image)
                            : HeaderOf<int16_t, float, int16_t>(kNifti1, image);
}

}  // namespace latvox::client
