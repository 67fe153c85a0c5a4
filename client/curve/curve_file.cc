#include "client/curve/curve_file.h"

#include <filesystem>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/curve/svg_curves.h"
#include "client/curve/text_curves.h"
#include "client/mesh/mesh_file.h"

namespace latvox::client {

absl::StatusOr<Drawing> ReadCurveFile(const std::string& path) {
  const std::string extension = absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  const bool svg = extension == ".svg";
  if (!svg && extension != ".txt") {
    return absl::InvalidArgumentError(absl::StrCat(path, ": drawing format \"", extension, "\" is not .txt or .svg"));
  }
  const auto bytes = ReadBytes(path);
  if (!bytes.ok()) return bytes.status();
  auto polylines = svg ? ParseSvg(*bytes) : ParseText(*bytes);
  if (!polylines.ok()) {
    return absl::Status(polylines.status().code(), absl::StrCat(path, ": ", polylines.status().message()));
  }
  if (polylines->empty()) return absl::InvalidArgumentError(absl::StrCat(path, ": the drawing has no curve"));
  return Drawing{*std::move(polylines), svg};
}

}  // namespace latvox::client
