// Measures the core alone: from a valid mesh in memory to all bricks in memory.
#include <oneapi/tbb/global_control.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "core/base/kept_memory.h"
#include "tests/bench/arguments.h"
#include "tests/bench/measure.h"
#include "tests/bench/meshes.h"
#include "tests/bench/print.h"

namespace latvox {
namespace {

constexpr int kUsage = 2, kBadInput = 3;

// `milliseconds` becomes the time to make the mesh, or to read its file.
absl::StatusOr<TriangleMesh> MeshOf(const Arguments& arguments, double& milliseconds) {
  const auto start = std::chrono::steady_clock::now();
  auto mesh = MeshNamed(arguments.mesh);
  if (!mesh.ok()) return mesh.status();
  milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (auto status = CheckMesh(*mesh); !status.ok()) return status;
  return Copied(Subdivided(*std::move(mesh), arguments.subdivide), arguments.copies);
}

int Fail(int exit_status, const absl::Status& status) {
  absl::FPrintF(stderr, "latvox_bench: %s\n", status.message());
  return exit_status;
}

int RunOnce(std::vector<std::string> words) {
  const auto arguments = ParseArguments(std::move(words));
  if (!arguments.ok()) return Fail(kUsage, arguments.status());
  if (arguments->help) {
    std::cout << Help();
    return 0;
  }
  double read = 0;
  auto mesh = MeshOf(*arguments, read);
  if (!mesh.ok()) return Fail(kBadInput, mesh.status());
  auto measured = Measure(*arguments, *mesh, true);
  if (!measured.ok()) return Fail(kBadInput, measured.status());
  measured->read_milliseconds = read;
  std::cout << (arguments->json ? ToJson(*arguments, *measured) : ToText(*measured)) << '\n';
  return 0;
}

// Answers each line of standard input with a line of JSON. A mesh is kept until a line names another one.
class Lines {
 public:
  void Answer() {
    for (std::string line; std::getline(std::cin, line);) {
      const auto answer = AnswerTo(line);
      std::cout << (answer.ok() ? *answer : nlohmann::json{{"error", answer.status().message()}}.dump()) << std::endl;
    }
  }

 private:
  absl::StatusOr<std::string> AnswerTo(const std::string& line) {
    const auto arguments = ParseArguments(absl::StrSplit(line, ' ', absl::SkipEmpty()));
    if (!arguments.ok()) return arguments.status();
    if (auto status = Fetch(*arguments); !status.ok()) return status;
    auto measured = Measure(*arguments, mesh_, false);
    if (!measured.ok()) return measured.status();
    measured->read_milliseconds = read_;
    return ToJson(*arguments, *measured);
  }

  absl::Status Fetch(const Arguments& arguments) {
    const std::string name = absl::StrCat(arguments.mesh, " ", arguments.subdivide, " ", arguments.copies);
    if (name == name_) return absl::OkStatus();
    name_.clear();
    mesh_ = {};
    auto mesh = MeshOf(arguments, read_);
    if (!mesh.ok()) return mesh.status();
    mesh_ = *std::move(mesh);
    name_ = name;
    return absl::OkStatus();
  }

  std::string name_;
  TriangleMesh mesh_;
  double read_ = 0;
};

}  // namespace
}  // namespace latvox

int main(int argc, char** argv) {
  latvox::KeepHeap(latvox::kHeapOfJobs);  // like latvoxd
  // Otherwise there would be no more threads than cores, whatever an arena asks for.
  const oneapi::tbb::global_control any(oneapi::tbb::global_control::max_allowed_parallelism, latvox::kMaxThreads);
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words == std::vector<std::string>{"-"}) {
    latvox::Lines().Answer();
    return 0;
  }
  return latvox::RunOnce(words);
}
