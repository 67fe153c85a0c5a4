#include "client/mesh_files/ply_color.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

constexpr PlyNames kColorNames[] = {{"red", "green", "blue"}, {"diffuse_red", "diffuse_green", "diffuse_blue"}};

const PlyNames* ColorNamesOf(const PlyElement& element) {
  const auto are = [&](const PlyNames& names) { return Missing(element, names) == nullptr; };
  const auto* const found = std::find_if(std::begin(kColorNames), std::end(kColorNames), are);
  return found == std::end(kColorNames) ? nullptr : found;
}

// Returns the full intensity of a color of this type, or 0 if the type has no known one.
double FullScalar(PlyScalar type) {
  switch (type) {
    case PlyScalar::kUint8:
      return 255;
    case PlyScalar::kUint16:
      return 65535;
    case PlyScalar::kFloat32:
    case PlyScalar::kFloat64:
      return 1;
    default:
      return 0;
  }
}

}  // namespace

PlyColors::PlyColors(const PlyElement& element) : element_(element.name), names_(ColorNamesOf(element)) {}

bool PlyColors::Read(const PlyProperty& property, uint64_t n, PlyBody& body) {
  const auto part = names_ != nullptr ? PositionOf(property, *names_) : std::nullopt;
  if (!part) return false;
  color_[*part] = ToPart(body.ReadNumber(property.type), property, n);
  return true;
}

// Returns 0, and keeps the reason, if the number is no component of a color.
uint8_t PlyColors::ToPart(double number, const PlyProperty& property, uint64_t n) {
  const double full = FullScalar(property.type);
  if (full > 0 && number >= 0 && number <= full) return static_cast<uint8_t>(std::nearbyint(number / full * 255));
  if (fault_.empty()) {
    fault_ = full > 0 ? absl::StrCat(property.name, " ", number, " of ", element_, " ", n, " is not within 0 and ",
                                     full, ", the range of type ", NameOf(property.type))
                      : absl::StrCat(property.name, " of element ", element_, " is ", NameOf(property.type),
                                     ", which is not one of uchar, ushort, float, double");
  }
  return 0;
}

}  // namespace latvox::client
