#include "client/tool/cli/render_command.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "client/internal/vec3.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/grid_input.h"
#include "client/tool/cli/picture_style_option.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/output/file_metadata.h"
#include "client/tool/output/picture_scene.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {
namespace {

std::string CheckView(const std::string& text) {
  std::array<double, 2> view;
  if (ParseNumbers(text, view) && std::abs(view[0]) <= 360 && std::abs(view[1]) <= 90) return "";
  return absl::StrCat("\"", text, "\" is not AZIMUTH,ELEVATION in degrees, at most 360 and 90");
}

}  // namespace

void AddRenderOptions(CommandParser& command, RenderWords& words) {
  command.Add({GridFileRow(words.input),
               OutputRow({".png"}, words.outputs, /*several=*/false),
               SizeRow("Pixels along each side of the picture", words.picture.side),
               {.names = "--view-up",
                .target = &words.view_up,
                .help = "Axis that points up",
                .words = WordsOf(UpNames()),
                .word_help = {"z points up", "x points up", "y points up"},
                .standard = "y"},
               {.names = "--view",
                .target = &words.view,
                .help = "Position of the viewer in degrees: angle about the up axis, and height above the horizon",
                .value = "AZIMUTH,ELEVATION",
                .checks = {{CheckView}},
                .standard = "30,22"},
               {.names = "--color",
                .target = &words.color,
                .help = "Color of the surface",
                .value = "RRGGBB",
                .checks = {{CheckColor}},
                .standard = "769ed2"}});
  command.Add(ColorByRows(words.color_by));
  AddPictureStyleOptions(command, "End the picture near the voxels; --size is its longer side", words.style);
}

PictureOptions Interpret(const RenderWords& words) {
  if (words.outputs.size() != 1) Refuse("--out: one file, not ", words.outputs.size());
  CheckOutputs(words.outputs, words.input, "file");
  PictureOptions options = words.picture;
  if (!words.view_up.empty()) options.up = ValueNamed(UpNames(), words.view_up);
  if (std::array<double, 2> view; ParseNumbers(words.view, view)) {
    options.azimuth = view[0];
    options.elevation = view[1];
  }
  Check(words.color_by);
  if (!words.color.empty() && !words.color_by.label.empty()) Refuse("--color: cannot be combined with --label");
  if (!words.color.empty() && !words.color_by.source.empty())
    Refuse("--color: cannot be combined with --color-by ", words.color_by.source);
  if (!words.color.empty()) options.color = ParseColor(words.color);
  options.crop = words.style.crop;
  return options;
}

absl::StatusOr<std::string> RunRender(const RenderWords& words, const PictureOptions& given) {
  const absl::Time start = absl::Now();
  const std::string& output = words.outputs.front();
  auto content = ReadInputContent(words.input, /*values=*/true, given.cancellation);
  if (!content.ok()) return content.status();
  if (auto status = SelectLabel(words.color_by, words.input, *content); !status.ok()) return status;
  const bool is_band = HoldsBand(*content);
  // On the surface of a band, distances say little.
  const bool has_distances_alone = is_band && DefaultColorBy(TraitsOf(*content)) == ColorBy::kDistance;
  const bool plain = has_distances_alone || !words.color.empty();
  const ColorBy by = plain && words.color_by.empty() ? ColorBy::kNone : ColorByOf(words.color_by, false, *content);
  auto colors = FileColors(words.input, *content, by);
  if (!colors.ok()) return colors.status();
  PictureOptions options = given;
  options.style = StyleOf(words.style, *content, by);
  const GridTransform& transform = content->file.info.transform;
  std::vector<Brick> skin;
  if (is_band) skin = SkinOf(content->Batch(), SkinDepth(transform), *colors);
  const std::vector<Brick>& shown = is_band ? skin : content->file.bricks;
  VoxelScene scene(transform, ShiftFor(transform, DiagonalOf(shown, transform), options));
  AddBricks(shown, *colors, scene);
  scene.Seal();
  const auto png = DrawVoxels(scene, options);
  if (!png.ok()) return png.status();
  if (auto status = WriteAtomically(output, *png); !status.ok()) return status;
  return absl::StrFormat("%s: %d voxels%s%s\nwrote %s in %.2f s\n", words.input, content->file.info.active_voxels,
                         is_band ? " in the band; the picture shows those at the surface" : "",
                         ColoredText(words.color_by, by), output, absl::ToDoubleSeconds(absl::Now() - start));
}

}  // namespace latvox::client
