// Colors as numbers.
#ifndef LATVOX_CLIENT_MESH_FILES_COLOR_NUMBERS_H_
#define LATVOX_CLIENT_MESH_FILES_COLOR_NUMBERS_H_

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Colors in a file that does not tell their scale: 0 to 1, or 0 to 255. White stands for those that are missing.
class ColorNumbers {
 public:
  using Numbers = std::array<double, 3>;  // red, green, blue

  void Add(const Numbers& rgb);
  void AddMissing();

  size_t missing() const { return missing_; }
  size_t first_missing() const { return first_missing_; }  // the index; only if some are missing
  size_t size() const { return colors_.size(); }

  // Returns the colors as bytes. The scale is 0 to 1 if no number exceeds 1, except by a hundredth, which is clamped.
  // It is 0 to 255 if a number exceeds 2, or is 2 and all are integers. Errors: INVALID_ARGUMENT naming a number that
  // is on neither scale, and `element` with its index counted from `base`.
  absl::StatusOr<std::vector<Color>> ToBytes(const std::string& element, size_t base) const;

 private:
  std::vector<Numbers> colors_;  // NaN where missing
  size_t missing_ = 0, first_missing_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_COLOR_NUMBERS_H_
