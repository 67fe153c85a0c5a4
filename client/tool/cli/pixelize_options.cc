#include "client/tool/cli/pixelize_options.h"

#include "client/tool/cli/common_options.h"
#include "client/tool/output/pixel_output.h"

namespace latvox::client {
namespace {

const Names<NamedPlaneLattice>& PlaneLatticeNames() {
  static const auto* const kNames = new Names<NamedPlaneLattice>(NamesOfLattices(kNamedPlaneLattices));
  return *kNames;
}

const Names<LineAlgorithm>& LineAlgorithmNames() {
  static const auto* const kNames = new Names<LineAlgorithm>{{"exact", LineAlgorithm::kExact},
                                                             {"brute-force", LineAlgorithm::kBruteForce},
                                                             {"incremental", LineAlgorithm::kIncremental},
                                                             {"ibanez", LineAlgorithm::kIbanez}};
  return *kNames;
}

std::vector<OptionRow> PlaneLatticeRows(PixelizeWords& words) {
  return {{.names = "--lattice",
           .target = &words.lattice,
           .help = "Named lattice",
           .group = "Lattice",
           .words = WordsOf(PlaneLatticeNames()),
           .word_help = {"squares", "hexagons"},
           .standard = "square"},
          {.names = "--basis",
           .target = &words.basis,
           .help = "Two basis vectors a, b of any lattice, in units of the drawing",
           .value = "a1,a2,b1,b2",
           .checks = {{CheckNumbers<double, 4>}}},
          {.names = "--pixel-size",
           .target = &words.pixel_size,
           .help = "Edge of a square that has a pixel's area, in units of the drawing",
           .value = "S",
           .checks = {{CheckPositive}}},
          {.names = "--resolution",
           .target = &words.resolution,
           .help = "Pixels along the drawing's longer side",
           .value = "N",
           .checks = {Whole(kMinResolution, kMaxResolution)}},
          {.names = "--origin",
           .target = &words.origin,
           .help = "Position of lattice point 0",
           .value = "X,Y",
           .checks = {{CheckNumbers<double, 2>}},
           .standard = "low corner of the drawing"}};
}

std::vector<OptionRow> PixelRows(PixelizeWords& words) {
  PixelizeRequest& request = words.options.request;
  return {
      {.names = "--separability",
       .target = &request.separability,
       .help = "Strength of separation, 0 strongest",
       .group = "Pixels",
       .words = {"0", "1"},
       .word_help = {"no path, not even across corners", "no path across edges"},
       .standard = "0"},
      {.names = "--minimal,!--no-minimal",
       .target = &request.minimal,
       .help = "Remove every pixel that separation does not need (default), or keep them"},
      {.names = "--algorithm",
       .target = &words.algorithm,
       .help = "Algorithm; the others exist for comparison",
       .words = WordsOf(LineAlgorithmNames()),
       .word_help = {"k-separating and k-minimal", "the thesis's, chapter 3", "the thesis's, chapter 3", "Ibanez's"},
       .standard = "exact"}};
}

}  // namespace

void AddPixelizeOptions(CommandParser& command, PixelizeWords& words) {
  PixelizeOptions& options = words.options;
  command.Add({{.names = "input",
                .target = &options.input,
                .help = "Drawing: .svg, .txt with one polyline per line (x,y x,y ... [z]), or - for standard input",
                .value = "INPUT",
                .required = true}});
  OptionRow output = OutputRow(PixelExtensions(), options.outputs, /*several=*/true);
  output.group = "Output";
  command.Add({std::move(output)});
  command.Add(PlaneLatticeRows(words));
  command.Add(PixelRows(words));
  OptionRow json = JsonRow("Print the summary as JSON", options.json);
  json.group = "Output";
  command.Add({std::move(json)});
  command.Exclude({{"--basis", "--lattice"}, {"--resolution", "--pixel-size"}});
  AddServerOptions(command, options.server);
}

PixelizeOptions Interpret(const PixelizeWords& words) {
  PixelizeOptions options = words.options;
  PixelizeRequest& request = options.request;
  if (words.basis.empty()) {
    request.lattice = ValueNamed(PlaneLatticeNames(), words.lattice);
  } else {
    std::array<double, 4> n{};
    ParseNumbers(words.basis, n);
    request.lattice = PlaneBasis{{n[0], n[1]}, {n[2], n[3]}};
  }
  request.algorithm = ValueNamed(LineAlgorithmNames(), words.algorithm);
  if (!words.pixel_size.empty()) ParseNumber(words.pixel_size, request.pixel_size.emplace());
  if (!words.resolution.empty()) ParseNumber(words.resolution, request.resolution.emplace());
  if (!words.origin.empty()) ParseNumbers(words.origin, request.origin.emplace());
  if (words.basis.empty() && !request.pixel_size && !request.resolution) {
    Refuse("--pixel-size or --resolution is required for a named lattice");
  }
  CheckOutputs(options.outputs, options.input, "drawing");
  return options;
}

}  // namespace latvox::client
