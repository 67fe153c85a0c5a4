#include "client/tool/output/image_header.h"

#include <cstring>
#include <span>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
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

std::string MetaImageHead(const ImageFacts& image, const std::string& compression, const std::string& data_file) {
  const Vec3d* const steps[] = {&image.basis.a, &image.basis.b, &image.basis.c};
  std::string rows;
  Vec3d spacing{};
  for (size_t n = 0; n < 3; ++n) {
    spacing[n] = Length(*steps[n]);
    absl::StrAppend(&rows, n == 0 ? "" : " ", Numbers(Unit(*steps[n]), " "));
  }
  return absl::StrCat("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n", compression,
                      "TransformMatrix = ", rows, "\nOffset = ", Numbers(image.corner, " "),
                      "\nCenterOfRotation = 0 0 0\nElementSpacing = ", Numbers(spacing, " "),
                      "\nDimSize = ", absl::StrJoin(image.shape, " "), "\nElementNumberOfChannels = ", image.components,
                      "\nElementType = ", NamesOf(image.type).meta_image, "\nElementDataFile = ", data_file, "\n");
}

}  // namespace

std::string NrrdHeader(const ImageFacts& image) {
  const auto& [a, b, c] = image.basis;
  const bool many = image.components > 1;
  const std::string first = absl::StrCat(image.components, " ");
  return absl::StrCat("NRRD0005\ncontent: ", image.name, "\ntype: ", NamesOf(image.type).nrrd,
                      "\ndimension: ", many ? 4 : 3, "\nspace: left-posterior-superior\nsizes: ", many ? first : "",
                      absl::StrJoin(image.shape, " "), "\nspace directions: ", many ? "none " : "", "(",
                      Numbers(a, ","), ") (", Numbers(b, ","), ") (", Numbers(c, ","), ")\nkinds: ",
                      image.type == NumberType::kUint8 && many ? "RGB-color "
                      : many                                   ? "vector "
                                                               : "",
                      "domain domain domain\nendian: little\nencoding: gzip\nspace origin: (",
                      Numbers(image.corner, ","), ")\n\n");
}

std::string MetaImageHeader(const ImageFacts& image, uint64_t compressed_bytes) {
  return MetaImageHead(image, absl::StrFormat("CompressedData = True\nCompressedDataSize = %020d\n", compressed_bytes),
                       "LOCAL");
}

std::string MetaImageHeader(const ImageFacts& image, const std::string& data_file) {
  return MetaImageHead(image, "CompressedData = False\n", data_file);
}

std::string NiftiHeader(const ImageFacts& image) {
  constexpr int16_t kRgb24 = 128, kVector = 1007, kAlignedToAnother = 2;
  constexpr size_t kBytes = 352;
  std::string header(kBytes, '\0');
  const auto put = [&header](size_t at, const auto& value) { std::memcpy(&header[at], &value, sizeof(value)); };
  const bool is_color = image.type == NumberType::kUint8 && image.components == 3;
  const bool is_vector = image.components > 1 && !is_color;
  std::array<int16_t, 8> sides;
  std::array<float, 8> spacing;
  sides.fill(1);
  spacing.fill(1);
  sides[0] = is_vector ? 5 : 3;
  const Vec3d* const steps[] = {&image.basis.a, &image.basis.b, &image.basis.c};
  for (size_t n = 0; n < 3; ++n) {
    sides[n + 1] = static_cast<int16_t>(image.shape[n]);
    spacing[n + 1] = static_cast<float>(Length(*steps[n]));
    std::array<float, 4> row;
    for (size_t m = 0; m < 3; ++m) row[m] = static_cast<float>((*steps[m])[n]);
    row[3] = static_cast<float>(image.corner[n]);
    put(280 + 16 * n, row);  // srow_x, srow_y, srow_z
  }
  if (is_vector) sides[5] = static_cast<int16_t>(image.components);
  const TypeNames names = NamesOf(image.type);
  put(0, int32_t{348});  // the header's bytes without the flag of extensions
  put(40, sides);
  if (is_vector) put(68, kVector);
  put(70, is_color ? kRgb24 : names.nifti);
  put(72, static_cast<int16_t>(is_color ? 3 * names.bits : names.bits));
  put(76, spacing);
  put(108, static_cast<float>(kBytes));  // where the data begin
  put(254, kAlignedToAnother);
  header.replace(328, image.name.size(), image.name);  // at most 15 bytes
  header.replace(344, 3, "n+1");
  return header;
}

}  // namespace latvox::client
