#include "client/tool/curve/curve_file.h"

#include <filesystem>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/mesh_files/input.h"
#include "client/tool/curve/svg_curves.h"
#include "client/tool/curve/text_curves.h"

namespace latvox::client {

absl::StatusOr<Drawing> ReadCurveFile(const std::string& path) {
  const bool standard_input = path == kStandardInput;
  const std::string extension = absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  if (!standard_input && extension != ".svg" && extension != ".txt") {
    return absl::InvalidArgumentError(absl::StrCat(path, ": drawing format \"", extension, "\" is not .txt or .svg"));
  }
  const auto bytes = standard_input ? ReadStandardInput("a drawing") : ReadBytes(path);
  if (!bytes.ok()) return bytes.status();
  const bool svg =
      standard_input ? absl::StartsWith(absl::StripLeadingAsciiWhitespace(*bytes), "<") : extension == ".svg";
  auto polylines = svg ? ParseSvg(*bytes) : ParseText(*bytes);
  if (!polylines.ok()) {
    return absl::Status(polylines.status().code(), absl::StrCat(NameOfInput(path), ": ", polylines.status().message()));
  }
  if (polylines->empty())
    return absl::InvalidArgumentError(absl::StrCat(NameOfInput(path), ": the drawing has no curve"));
  return Drawing{*std::move(polylines), svg};
}

}  // namespace latvox::client
