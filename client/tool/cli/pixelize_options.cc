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
           .help = "default: square",
           .group = "Lattice",
           .words = WordsOf(PlaneLatticeNames())},
          {.names = "--basis",
           .target = &words.basis,
           .help = "two basis vectors a, b of any lattice, the drawing's units",
           .value = "a1,a2,b1,b2",
           .checks = {{CheckNumbers<double, 4>}}},
          {.names = "--pixel-size",
           .target = &words.pixel_size,
           .help = "edge of a square with a pixel's area, the drawing's units",
           .value = "S",
           .checks = {{CheckPositive}}},
          {.names = "--resolution",
           .target = &words.resolution,
           .help = "pixels along the drawing's longer side, 2 to 65536",
           .value = "N",
           .checks = {Whole(kMinResolution, kMaxResolution)}},
          {.names = "--origin",
           .target = &words.origin,
           .help = "position of lattice point 0 (default: the drawing's low corner)",
           .value = "X,Y",
           .checks = {{CheckNumbers<double, 2>}}}};
}

std::vector<OptionRow> PixelRows(PixelizeWords& words) {
  PixelizeRequest& request = words.options.request;
  return {{.names = "--separability",
           .target = &request.separability,
           .help = "0 (stronger, the default) or 1",
           .value = "K",
           .group = "Pixels",
           .words = {"0", "1"}},
          {.names = "--minimal,!--no-minimal",
           .target = &request.minimal,
           .help = "remove every pixel that can go (default)"},
          {.names = "--algorithm",
           .target = &words.algorithm,
           .help = "default: exact; the others are there to compare with",
           .words = WordsOf(LineAlgorithmNames())}};
}

}  // namespace

void AddPixelizeOptions(CommandParser& command, PixelizeWords& words) {
  PixelizeOptions& options = words.options;
  command.Add({{.names = "input",
                .target = &options.input,
                .help = "drawing: .txt (a polyline a line: x,y x,y ... [z]) or .svg, or - for standard input",
                .value = "INPUT",
                .required = true}});
  OptionRow output = OutputRow(PixelExtensions(), options.outputs);
  output.group = "Output";
  command.Add({std::move(output)});
  command.Add(PlaneLatticeRows(words));
  command.Add(PixelRows(words));
  OptionRow json = JsonRow("machine-readable summary on standard output", options.json);
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
