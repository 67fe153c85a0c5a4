#include "client/mesh_files/obj_vertices.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "client/mesh_files/color_numbers.h"
#include "client/mesh_files/number_text.h"
#include "client/mesh_files/obj_statements.h"

namespace latvox::client {
namespace {

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

// The numbers after x, y and z.
struct Rest {
  std::array<double, 5> numbers{};
  size_t count = 0;  // at most 5: so many are too many
};

Rest ReadRest(absl::string_view words) {
  Rest rest;
  while (rest.count < rest.numbers.size() && ParseDouble(TakeWord(words), rest.numbers[rest.count])) ++rest.count;
  return rest;
}

class Vertices {
 public:
  Vertices(BadElements& bad, Mesh& mesh) : bad_(bad), mesh_(mesh) {}

  absl::Status Read(absl::string_view words, size_t line) {
    Vec3d position;
    for (double& coordinate : position) {
      const absl::string_view word = TakeWord(words);
      if (ParseDouble(word, coordinate)) continue;
      const size_t number = mesh_.positions.size() + 1;
      auto error = LineError(line, "coordinate \"", word, "\" of vertex ", number, " is not a number");
      if (auto status = bad_.Add(error, NameOfLine(line)); !status.ok()) return status;
      position.fill(kAbsent);
      break;
    }
    mesh_.positions.push_back(position);
    TakeRest(ReadRest(words), line);
    return absl::OkStatus();
  }

  void Finish() {
    if (weights_ > 0) {
      mesh_.warnings.push_back({"IGNORED_WEIGHTS",
                                absl::StrCat(weights_, " vertices have a weight other than 1, which is not applied; ",
                                             "the first: line ", first_weight_),
                                NameOfLine(first_weight_)});
    }
    if (colors_.empty()) return;
    ColorNumbers numbers;
    for (const FourNumbers& color : colors_) {
      // Without a fourth number, or with a fourth number that is opacity, red comes first.
      const size_t red = std::isnan(color[3]) || !all_weigh_1_ ? 0 : 1;
      if (std::isnan(color[0])) {
        numbers.AddMissing();
      } else {
        numbers.Add({color[red], color[red + 1], color[red + 2]});
      }
    }
    while (numbers.size() < mesh_.positions.size()) numbers.AddMissing();
    TakeColors(numbers);
  }

 private:
  using FourNumbers = std::array<double, 4>;

  void TakeRest(const Rest& rest, size_t line) {
    const auto& n = rest.numbers;
    const bool colored = rest.count == 3 || rest.count == 4;
    if (colored) {
      // The vertices before had none.
      colors_.resize(mesh_.positions.size() - 1, {kAbsent, kAbsent, kAbsent, kAbsent});
      colors_.push_back({n[0], n[1], n[2], rest.count == 4 ? n[3] : kAbsent});
      if (std::isnan(n[0])) colors_.back()[0] = -1;  // which is no color
      all_weigh_1_ = all_weigh_1_ && (rest.count == 3 || n[0] == 1);
    } else if (rest.count == 1 && n[0] != 1) {
      if (weights_++ == 0) first_weight_ = line;
    } else if (rest.count > 1 && mesh_.no_color.empty()) {
      mesh_.no_color = absl::StrCat("line ", line, ": ", rest.count, " numbers after x, y and z are no color");
    }
  }

  void TakeColors(const ColorNumbers& numbers) {
    auto bytes = numbers.ToBytes("vertex", 1);
    if (!bytes.ok()) {
      mesh_.no_color = std::string(bytes.status().message());
      return;
    }
    mesh_.colors = *std::move(bytes);
    if (numbers.missing() == 0) return;
    mesh_.warnings.push_back(
        {"PARTIAL_COLORS",
         absl::StrCat(numbers.missing(), " of ", numbers.size(),
                      " vertices have no color, and are white; the first: vertex ", numbers.first_missing() + 1),
         absl::StrCat("vertex ", numbers.first_missing() + 1)});
  }

  BadElements& bad_;
  Mesh& mesh_;
  std::vector<FourNumbers> colors_;  // the last is NaN without a fourth number, all are where there is no color
  bool all_weigh_1_ = true;          // the first of four numbers is 1 everywhere
  uint64_t weights_ = 0;             // other than 1
  size_t first_weight_ = 0;          // the line
};

}  // namespace

absl::Status ReadObjVertices(absl::string_view text, BadElements& bad, Mesh& mesh) {
  ObjStatements statements(text);
  Vertices vertices(bad, mesh);
  for (absl::string_view words; statements.Next(words);) {
    // Most other lines end here, because splitting words takes most of this pass.
    if (!words.empty() && words[0] > ' ' && words[0] != 'v') continue;
    if (TakeWord(words) != "v") continue;
    if (auto status = vertices.Read(words, statements.line()); !status.ok()) return status;
  }
  vertices.Finish();
  return absl::OkStatus();
}

}  // namespace latvox::client
