#include "client/cli/render_command.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "client/cli/common_options.h"
#include "client/grid/voxel_grid.h"
#include "client/output/atomic_file.h"
#include "client/output/vec3.h"

namespace latvox::client {
namespace {

std::string CheckView(const std::string& text) {
  std::array<double, 2> view;
  if (ParseNumbers(text, view) && std::abs(view[0]) <= 360 && std::abs(view[1]) <= 90) return "";
  return absl::StrCat("\"", text, "\" is not AZIMUTH,ELEVATION in degrees, at most 360 and 90");
}

std::string CheckColor(const std::string& text) {
  const bool hex = text.size() == 6 && text.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos;
  return hex ? "" : absl::StrCat("\"", text, "\" is not RRGGBB, six hexadecimal digits");
}

// The diagonal of the box of lattice points, in world units.
double DiagonalOf(const GridFileInfo& info) {
  if (!info.active_box) return 0;
  double longest = 0;
  for (int corner = 0; corner < 4; ++corner) {
    Vec3d across{};
    for (size_t m = 0; m < 3; ++m) {
      const double side = static_cast<double>(int64_t{info.active_box->max[m]} - info.active_box->min[m]);
      across[m] = m < 2 && (corner >> m & 1) != 0 ? -side : side;
    }
    longest = std::max(longest, Length(Combine(info.transform.basis, across)));
  }
  return longest;
}

}  // namespace

void AddRenderOptions(CLI::App& command, RenderWords& words) {
  command.add_option("file", words.input, "a .vdb file")->type_name("IN.vdb")->required();
  AddOutputOption(command, {".png"}, words.outputs);
  AddSizeOption(command, "pixels of each side", words.picture.side);
  command.add_option("--up", words.up, "the axis that points up (default: y)")->check(OneOf(UpNames()));
  command
      .add_option("--view", words.view,
                  "where the viewer is, degrees: about the axis that points up, and above (default: 30,22)")
      ->type_name("AZIMUTH,ELEVATION")
      ->check(CheckView);
  command.add_option("--color", words.color, "of the surface (default: 769ed2)")
      ->type_name("RRGGBB")
      ->check(CheckColor);
}

PictureOptions Interpret(const RenderWords& words) {
  if (words.outputs.size() != 1) Refuse("--out: one file, not ", words.outputs.size());
  CheckOutputs(words.outputs, words.input, "file");
  PictureOptions options = words.picture;
  if (!words.up.empty()) options.up = ValueNamed(UpNames(), words.up);
  if (std::array<double, 2> view; ParseNumbers(words.view, view)) {
    options.azimuth = view[0];
    options.elevation = view[1];
  }
  if (!words.color.empty()) {
    const std::string bytes = absl::HexStringToBytes(words.color);
    for (size_t m = 0; m < 3; ++m) options.color[m] = static_cast<uint8_t>(bytes[m]);
  }
  return options;
}

absl::StatusOr<std::string> RunRender(const RenderWords& words, const PictureOptions& options) {
  const absl::Time start = absl::Now();
  const std::string& output = words.outputs.front();
  const auto grid = ReadGridFile(words.input);
  if (!grid.ok()) return grid.status();
  const GridTransform& transform = grid->info.transform;
  VoxelScene scene(transform, ShiftFor(transform, DiagonalOf(grid->info), options));
  for (const Brick& brick : grid->bricks) scene.Add(brick);
  scene.Seal();
  const auto png = DrawVoxels(scene, options);
  if (!png.ok()) return png.status();
  if (auto status = WriteAtomically(output, *png); !status.ok()) return status;
  return absl::StrFormat("%s: %d voxels\nwrote %s in %.2f s\n", words.input, grid->info.active_voxels, output,
                         absl::ToDoubleSeconds(absl::Now() - start));
}

}  // namespace latvox::client
