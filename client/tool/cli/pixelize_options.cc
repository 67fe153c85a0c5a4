#include "client/tool/cli/pixelize_options.h"

#include <CLI/CLI.hpp>

#include "client/tool/cli/common_options.h"
#include "client/tool/output/pixel_output.h"

namespace latvox::client {
namespace {

const Names<NamedPlaneLattice>& LatticeNames() {
  static const auto* const kNames = new Names<NamedPlaneLattice>(NamesOfLattices(kNamedPlaneLattices));
  return *kNames;
}

const Names<LineAlgorithm>& AlgorithmNames() {
  static const auto* const kNames = new Names<LineAlgorithm>{{"exact", LineAlgorithm::kExact},
                                                             {"brute-force", LineAlgorithm::kBruteForce},
                                                             {"incremental", LineAlgorithm::kIncremental},
                                                             {"ibanez", LineAlgorithm::kIbanez}};
  return *kNames;
}

}  // namespace

void AddPixelizeOptions(CLI::App& command, PixelizeWords& words) {
  PixelizeOptions& options = words.options;
  command
      .add_option("input", options.input,
                  "drawing: .txt (a polyline a line: x,y x,y ... [z]) or .svg, or - for standard input")
      ->type_name("INPUT")
      ->required();
  Group(command, "Output");
  AddOutputOption(command, PixelExtensions(), options.outputs);
  Group(command, "Lattice");
  CLI::Option* lattice =
      command.add_option("--lattice", words.lattice, "default: square")->check(OneOf(LatticeNames()));
  command.add_option("--basis", words.basis, "two basis vectors a, b of any lattice, the drawing's units")
      ->type_name("a1,a2,b1,b2")
      ->check(CheckNumbers<double, 4>)
      ->excludes(lattice);
  CLI::Option* pixel_size =
      command.add_option("--pixel-size", words.pixel_size, "edge of a square with a pixel's area, the drawing's units")
          ->type_name("S")
          ->check(CheckPositive);
  command.add_option("--resolution", words.resolution, "pixels along the drawing's longer side, 2 to 65536")
      ->type_name("N")
      ->check(Whole(kMinResolution, kMaxResolution))
      ->excludes(pixel_size);
  command.add_option("--origin", words.origin, "position of lattice point 0 (default: the drawing's low corner)")
      ->type_name("X,Y")
      ->check(CheckNumbers<double, 2>);
  Group(command, "Pixels");
  command.add_option("--separability", options.request.separability, "0 (stronger, the default) or 1")
      ->type_name("K")
      ->check(CLI::IsMember({0, 1}));
  command.add_flag("--minimal,!--no-minimal", options.request.minimal, "remove every pixel that can go (default)");
  command.add_option("--algorithm", words.algorithm, "default: exact; the others are there to compare with")
      ->check(OneOf(AlgorithmNames()));
  Group(command, "Output");
  command.add_flag("--json", options.json, "machine-readable summary on standard output");
  AddServerOptions(command, options.server);
}

PixelizeOptions Interpret(const PixelizeWords& words) {
  PixelizeOptions options = words.options;
  PixelizeRequest& request = options.request;
  if (words.basis.empty()) {
    request.lattice = ValueNamed(LatticeNames(), words.lattice);
  } else {
    std::array<double, 4> n{};
    ParseNumbers(words.basis, n);
    request.lattice = PlaneBasis{{n[0], n[1]}, {n[2], n[3]}};
  }
  request.algorithm = ValueNamed(AlgorithmNames(), words.algorithm);
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
